"""Trains the demo's person detector: a tiny Florence-2 (transformers' own classes) from scratch, exported as ONNX.

    python train_detector.py --data DIR [DIR ...] --test DIR --out OUT [--steps N]

The prompt is that of <OD>; the answer is `person<loc_x0><loc_y0><loc_x1><loc_y1>person...`, ordered by x0.
Training aids, none of which is in the exported graphs:
  * location embeddings (tied with the output layer) start as Fourier features of their coordinate, and location targets are small
    Gaussians over neighbouring bins that narrow as training goes on: 1000 bins become one smooth scale;
  * image position embeddings start as the same Fourier features of the cell's centre;
  * a dense head on the text encoder's image tokens (objectness and four location distributions per cell, through the same tied
    embeddings) teaches the encoder to hold everybody's box, so that the decoder only has to pick one and copy it.
"""
import argparse
import json
import math
import os
import time

import numpy as np
import torch
import torch.nn.functional as F

import common as C

PROMPT = "Locate the objects with category name in the image."
BINS = 1000
# People of whom less is seen, or who are narrower (pixels of a 640 pixel tile), are neither wanted nor wrong.
VISIBLE_MIN, WIDTH_MIN = 0.3, 12 / 640
STRIDES, DIMS, HEADS = [4, 2, 2, 1], [16, 32, 64, 96], [1, 2, 4, 4]
D, ENCODER_LAYERS, DECODER_LAYERS, FFN = 96, 1, 2, 192
SIGMA = (8.0, 3.0)
MAX_IDS = 64


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--data", nargs="+", required=True)
    parser.add_argument("--test", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--steps", type=int, default=5000)
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--eval-every", type=int, default=400)
    return parser.parse_args()


def tokenizer(folder):
    from transformers import AddedToken, BartTokenizerFast

    corpus = [PROMPT, "Locate person in the image.", "person", "human", "man", "woman", "child", "chair", "table"] * 8
    vocab, merges = C.byte_bpe(corpus, 340, ["<s>", "<pad>", "</s>", "<unk>"], folder)
    made = BartTokenizerFast(vocab_file=vocab, merges_file=merges, model_max_length=1024)
    extra = ["<od>", "</od>", "<ocr>", "</ocr>"] + [f"<loc_{i}>" for i in range(BINS)]
    extra += ["<cap>", "</cap>", "<ncap>", "</ncap>", "<dcap>", "</dcap>", "<grounding>", "</grounding>", "<seg>", "</seg>", "<sep>"]
    extra += ["<region_cap>", "</region_cap>", "<region_to_desciption>", "</region_to_desciption>", "<proposal>", "</proposal>"]
    made.add_special_tokens({"additional_special_tokens": extra + ["<poly>", "</poly>", "<and>"]})
    made.add_tokens(AddedToken("<image>", special=True, normalized=False), special_tokens=True)
    return made


def fourier(x, size):
    """x in [0, 1], [N] -> [N, size]: sines and cosines from half a period to 48 periods."""
    periods = 0.5 * 96.0 ** (torch.arange(size // 2) / (size // 2 - 1))
    angle = 2 * math.pi * x[:, None] * periods[None]
    return torch.cat([angle.sin(), angle.cos()], 1)


def build(tok, side):
    from transformers import BartConfig, Florence2Config, Florence2ForConditionalGeneration

    text = BartConfig(
        vocab_size=len(tok), d_model=D, encoder_layers=ENCODER_LAYERS, decoder_layers=DECODER_LAYERS, encoder_attention_heads=4,
        decoder_attention_heads=4, encoder_ffn_dim=FFN, decoder_ffn_dim=FFN, max_position_embeddings=256, dropout=0.0, attention_dropout=0.0,
        activation_dropout=0.0, scale_embedding=False, bos_token_id=0, pad_token_id=1, eos_token_id=2, decoder_start_token_id=2,
        forced_bos_token_id=None, forced_eos_token_id=None, init_std=0.05,
    )
    vision = dict(
        depths=[1, 1, 1, 1], patch_size=[7, 3, 3, 3], patch_stride=STRIDES, patch_padding=[3, 1, 1, 1], patch_prenorm=[False, True, True, True],
        embed_dim=DIMS, num_heads=HEADS, num_groups=HEADS, window_size=10, projection_dim=D, max_temporal_embeddings=4,
        max_position_embeddings=24, drop_path_rate=0.0,
    )
    image_token = tok.convert_tokens_to_ids("<image>")
    config = Florence2Config(text_config=text.to_dict(), vision_config=vision, image_token_id=image_token, tie_word_embeddings=True)
    config._attn_implementation = "sdpa"
    model = Florence2ForConditionalGeneration(config)
    loc0, grid = tok.convert_tokens_to_ids("<loc_0>"), side // math.prod(STRIDES)
    with torch.no_grad():
        for name, p in model.named_parameters():
            if "vision_tower" in name and p.dim() > 1:
                p.normal_(0, 1.0 / math.sqrt(p[0].numel()))
            if "image_projection" in name:
                p.normal_(0, 1 / math.sqrt(p.shape[1]))
            if "image_position_embed" in name:
                p.normal_(0, 0.3)
                p[:grid] = fourier((torch.arange(grid) + 0.5) / grid, p.shape[1])
        table = model.get_input_embeddings().weight
        table[loc0:loc0 + BINS] = 0.1 * fourier((torch.arange(BINS) + 0.5) / BINS, D)
    g = model.generation_config
    g.bos_token_id, g.pad_token_id, g.eos_token_id, g.decoder_start_token_id = 0, 1, 2, 2
    # Location targets are soft, so sequence probabilities are flat and beams would prefer short answers: one beam.
    g.forced_bos_token_id, g.forced_eos_token_id, g.no_repeat_ngram_size, g.num_beams, g.early_stopping = 0, 2, 3, 1, False
    g.max_length = MAX_IDS
    return model, loc0, grid


class Dense(torch.nn.Module):
    """Training-only head on the image tokens of the text encoder."""

    def __init__(self):
        super().__init__()
        self.objectness, self.box = torch.nn.Linear(D, 1), torch.nn.Linear(D, 4 * D)
        torch.nn.init.constant_(self.objectness.bias, -3.0)


def encode(model, pictures, prompt):
    language = model.model.language_model
    image = model.get_image_features(pictures)
    text = language.get_input_embeddings()(prompt)[None].expand(len(pictures), -1, -1)
    return language.encoder(inputs_embeds=torch.cat([image, text], 1), return_dict=True)[0], image.shape[1]


def wanted(boxes):
    """Rows of x0, y0, x1, y1 of those who count."""
    counts = (boxes[:, 4] >= VISIBLE_MIN) & (boxes[:, 2] - boxes[:, 0] >= WIDTH_MIN)
    return boxes[counts][:, :4], boxes[~counts][:, :4]


def bins(boxes):
    """Location bins, ordered by x0, then y0."""
    q = np.clip(np.floor(boxes * BINS), 0, BINS - 1).astype(np.int64)
    return q[np.lexsort((q[:, 1], q[:, 0]))]


def make_batch(tiles, boxes, index, rng, person, loc0, grid):
    pictures = torch.from_numpy(tiles[index]).permute(0, 3, 1, 2).float() / 255
    pictures = (pictures * (1 + 0.08 * torch.randn(len(index), 3, 1, 1)) - C.MEAN) / C.STD
    sequences, cells, cell_boxes = [], [], []
    for row, tile in enumerate(index):
        people = wanted(boxes[tile])[0].copy()
        if rng.rand() < 0.5:
            pictures[row] = pictures[row].flip(-1)
            people[:, [0, 2]] = 1 - people[:, [2, 0]]
        ids = [0]
        for q in bins(people):
            ids += person + [loc0 + int(v) for v in q]
            column, line = (q[0] + q[2]) / 2, q[1] + 0.3 * (q[3] - q[1])
            cells.append((row, min(grid - 1, int(line * grid / BINS)), min(grid - 1, int(column * grid / BINS))))
            cell_boxes.append(q)
        sequences.append(ids + [2])
    target = torch.full((len(index), max(map(len, sequences))), -100)
    for row, ids in enumerate(sequences):
        target[row, :len(ids)] = torch.tensor(ids)
    given = torch.full_like(target, 1)
    given[:, 0] = 2
    given[:, 1:] = torch.where(target[:, :-1] == -100, 1, target[:, :-1])
    return pictures, target, given, torch.tensor(cells, dtype=torch.long).view(-1, 3), torch.tensor(np.array(cell_boxes).reshape(-1, 4))


def soft_targets(sigma):
    i = torch.arange(BINS).float()
    g = torch.exp(-((i[None] - i[:, None]) ** 2) / (2 * sigma * sigma))
    g[g < 0.01] = 0
    return g / g.sum(1, keepdim=True)


def loss_of(model, dense, batch, prompt, loc0, grid, targets, dense_weight):
    pictures, target, given, cells, cell_boxes = batch
    hidden, image_tokens = encode(model, pictures, prompt)
    language = model.model.language_model
    out = language.decoder(input_ids=given, encoder_hidden_states=hidden, use_cache=False, return_dict=True)[0]
    valid = target != -100
    logs, y = model.lm_head(out[valid]).log_softmax(-1), target[valid]
    is_location = (y >= loc0) & (y < loc0 + BINS)
    words = -logs[~is_location].gather(1, y[~is_location][:, None]).mean()
    places = -(logs[is_location][:, loc0:loc0 + BINS] * targets[y[is_location] - loc0]).sum(1).mean() if is_location.any() else logs.sum() * 0
    grid_hidden = hidden[:, image_tokens - grid * grid:image_tokens]
    found, truth = dense.objectness(grid_hidden)[..., 0], torch.zeros(len(pictures), grid * grid)
    cell = cells[:, 1] * grid + cells[:, 2]
    truth[cells[:, 0], cell] = 1
    objects = F.binary_cross_entropy_with_logits(found, truth, reduction="sum") / max(1, len(cells))
    boxes = torch.zeros(())
    if len(cells):
        table = language.get_input_embeddings().weight[loc0:loc0 + BINS]
        z = dense.box(grid_hidden[cells[:, 0], cell]).view(-1, 4, D) @ table.T
        boxes = -(z.log_softmax(-1) * targets[cell_boxes]).sum(-1).mean()
    return words + places + dense_weight * (objects + boxes), [words.item(), places.item(), objects.item(), boxes.item()]


@torch.no_grad()
def greedy(model, pictures, prompt):
    """Ids without the start token and the log-probability of each, per picture; the prefix is run anew for every token."""
    hidden, _ = encode(model, pictures, prompt)
    language = model.model.language_model
    ids, logs = torch.full((len(pictures), 1), 2), []
    done = torch.zeros(len(pictures), dtype=torch.bool)
    while ids.shape[1] < MAX_IDS and not done.all():
        last = language.decoder(input_ids=ids, encoder_hidden_states=hidden, use_cache=False, return_dict=True)[0][:, -1]
        p = model.lm_head(last).log_softmax(-1)
        token = p.argmax(-1)
        token[done] = 1
        logs.append(p.gather(1, token[:, None])[:, 0])
        done |= token == 2
        ids = torch.cat([ids, token[:, None]], 1)
    return ids[:, 1:].tolist(), torch.stack(logs, 1).tolist()


def people_in(ids, logs, person, loc0):
    """Boxes in parts of the tile, each with the geometric mean probability of its tokens."""
    found, at, long = [], 0, len(person)
    while at < len(ids):
        q = [token - loc0 for token in ids[at + long:at + long + 4]]
        whole = len(q) == 4 and all(0 <= v < BINS for v in q)
        if ids[at:at + long] == person and whole and q[2] > q[0] and q[3] > q[1]:
            found.append(((np.array(q) + 0.5) / BINS, math.exp(np.mean(logs[at:at + long + 4]))))
            at += long + 4
        else:
            at += 1
    return found


def iou(a, b):
    w, h = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    if w <= 0 or h <= 0:
        return 0.0
    return w * h / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - w * h)


def average_precision(predictions, boxes, threshold):
    """All-points AP; predictions on ignored people count for nothing."""
    rows, total = [], 0
    for found, truth in zip(predictions, boxes):
        people, ignored = wanted(truth)
        total += len(people)
        used = set()
        for box, score in sorted(found, key=lambda item: -item[1]):
            best, k = max(((iou(box, person), k) for k, person in enumerate(people) if k not in used), default=(0, -1))
            if best >= threshold:
                used.add(k)
                rows.append((score, 1))
            elif not any(iou(box, other) > 0.3 for other in ignored):
                rows.append((score, 0))
    rows.sort(key=lambda row: -row[0])
    hits = np.cumsum([hit for _, hit in rows]) if rows else np.zeros(1)
    precision, recall = hits / np.arange(1, len(hits) + 1), hits / max(1, total)
    envelope = np.maximum.accumulate(precision[::-1])[::-1]
    area = float(np.sum(np.diff(np.concatenate([[0], recall])) * envelope))
    return dict(ap=round(area, 4), precision=round(float(precision[-1]), 4), recall=round(float(recall[-1]), 4))


def evaluate(model, tiles, boxes, prompt, person, loc0):
    model.eval()
    predictions = []
    for first in range(0, len(tiles), 50):
        ids, logs = greedy(model, C.pixels(tiles[first:first + 50]), prompt)
        predictions += [people_in(i, l, person, loc0) for i, l in zip(ids, logs)]
    model.train()
    return dict(average_precision(predictions, boxes, 0.5), ap75=average_precision(predictions, boxes, 0.75)["ap"])


def train(model, a, prompt, person, loc0, grid, report):
    tiles, boxes = C.load(a.data, "tiles"), C.load_boxes(a.data)
    test, test_boxes = C.load([a.test], "tiles"), C.load_boxes([a.test])
    dense, rng = Dense(), np.random.RandomState(a.seed)
    optimizer = C.adamw(list(model.named_parameters()) + list(dense.named_parameters()), a.rate)
    model.train()
    order, at, start, mean = rng.permutation(len(tiles)), 0, time.time(), None
    for step in range(a.steps):
        part = step / a.steps
        if step % 100 == 0:
            targets = soft_targets(SIGMA[0] + (SIGMA[1] - SIGMA[0]) * part)
        for group in optimizer.param_groups:
            group["lr"] = C.learning_rate(step, a.steps, a.rate)
        if at + a.batch > len(order):
            order, at = rng.permutation(len(tiles)), 0
        batch = make_batch(tiles, boxes, order[at:at + a.batch], rng, person, loc0, grid)
        at += a.batch
        loss, shown = loss_of(model, dense, batch, prompt, loc0, grid, targets, 1 - 0.7 * part)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        mean = np.array(shown) if mean is None else 0.98 * mean + 0.02 * np.array(shown)
        if (step + 1) % a.eval_every == 0:
            row = dict(step=step + 1, losses=mean.round(3).tolist(), **evaluate(model, test[:200], test_boxes[:200], prompt, person, loc0))
            report.append(row)
            print(f"{time.time() - start:.0f} s", json.dumps(row), flush=True)
    report.append(dict(final=True, **evaluate(model, test, test_boxes, prompt, person, loc0)))
    print(json.dumps(report[-1]), flush=True)


class Encoder(torch.nn.Module):
    def __init__(self, model):
        super().__init__()
        self.encoder = model.model.language_model.encoder

    def forward(self, attention_mask, inputs_embeds):
        return self.encoder(attention_mask=attention_mask, inputs_embeds=inputs_embeds, return_dict=True)[0]


class Decoder(torch.nn.Module):
    """Without a past: builds all four caches of a layer. With one: takes them and returns only those that grow."""

    def __init__(self, model, with_past):
        super().__init__()
        self.decoder, self.head, self.with_past = model.model.language_model.decoder, model.lm_head, with_past

    def forward(self, encoder_attention_mask, *rest):
        from transformers.cache_utils import EncoderDecoderCache

        if self.with_past:
            embeds, past = rest[0], rest[1:]
            cache = EncoderDecoderCache.from_legacy_cache(tuple(tuple(past[4 * i:4 * i + 4]) for i in range(DECODER_LAYERS)))
            hidden = torch.zeros(embeds.shape[0], 1, embeds.shape[2])  # never read: cross attention comes from the cache
        else:
            hidden, embeds = rest
            cache = EncoderDecoderCache.from_legacy_cache(None)
        out = self.decoder(
            inputs_embeds=embeds, encoder_hidden_states=hidden, encoder_attention_mask=encoder_attention_mask, past_key_values=cache,
            use_cache=True, return_dict=True,
        )
        result = [self.head(out.last_hidden_state)]
        for i in range(DECODER_LAYERS):
            own, cross = out.past_key_values.self_attention_cache.layers[i], out.past_key_values.cross_attention_cache.layers[i]
            result += [own.keys, own.values] + ([] if self.with_past else [cross.keys, cross.values])
        return tuple(result)


def export(model, side, folder):
    """The file split and tensor names of the community's Florence-2 exports."""
    path = lambda name: os.path.join(folder, name + ".onnx")
    batch = {0: "batch_size"}
    source, length = {**batch, 1: "encoder_sequence_length"}, {**batch, 1: "decoder_sequence_length"}
    keys = [f"{i}.{kind}.{part}" for i in range(DECODER_LAYERS) for kind in ("decoder", "encoder") for part in ("key", "value")]
    cached = lambda key: {**batch, 2: "past_sequence_length" if "decoder" in key else "encoder_sequence_length_out"}
    axes = {"encoder_attention_mask": source, "encoder_hidden_states": source, "inputs_embeds": length, "logits": length}
    axes |= {prefix + key: cached(key) for key in keys for prefix in ("past_key_values.", "present.")}
    mask = torch.ones(2, 11, dtype=torch.long)
    C.export(C.Vision(model), (torch.randn(2, 3, side, side),), path("vision_encoder"), ["pixel_values"], ["image_features"],
             {"pixel_values": batch, "image_features": batch})
    C.export(C.Embed(model), (torch.randint(0, 100, (2, 7)),), path("embed_tokens"), ["input_ids"], ["inputs_embeds"],
             {"input_ids": length, "inputs_embeds": length})
    C.export(Encoder(model), (mask, torch.randn(2, 11, D)), path("encoder_model"), ["attention_mask", "inputs_embeds"], ["last_hidden_state"],
             {"attention_mask": source, "inputs_embeds": source, "last_hidden_state": source})
    inputs, outputs = ["encoder_attention_mask", "encoder_hidden_states", "inputs_embeds"], ["logits"] + ["present." + key for key in keys]
    C.export(Decoder(model, False), (mask, torch.randn(2, 11, D), torch.randn(2, 3, D)), path("decoder_model"), inputs, outputs,
             {name: axes[name] for name in inputs + outputs})
    inputs = ["encoder_attention_mask", "inputs_embeds"] + ["past_key_values." + key for key in keys]
    outputs = ["logits"] + ["present." + key for key in keys if "decoder" in key]
    past = [torch.randn(2, 4, 5 if "decoder" in key else 11, D // 4) for key in keys]
    C.export(Decoder(model, True), (mask, torch.randn(2, 1, D), *past), path("decoder_with_past_model"), inputs, outputs,
             {name: axes[name] for name in inputs + outputs})


def goldens(model, tiles, prompt):
    """What the framework's own generation says of some unseen tiles, for the tests of the port."""
    rows = []
    for tile in range(len(tiles)):
        picture = C.pixels(tiles[tile:tile + 1])
        image = torch.full((model.get_image_features(picture).shape[1],), model.config.image_token_id)
        ids = torch.cat([image, prompt])[None]
        made = model.generate(input_ids=ids, attention_mask=torch.ones_like(ids), pixel_values=picture, do_sample=False)[0]
        rows.append([token for token in made.tolist() if token != 1])
    return rows


def main():
    a = arguments()
    torch.set_num_threads(a.threads)
    torch.manual_seed(a.seed)
    onnx_folder = os.path.join(a.out, "onnx")
    os.makedirs(onnx_folder, exist_ok=True)
    side = np.load(os.path.join(a.test, "tiles.npy"), mmap_mode="r").shape[1]
    tok = tokenizer(a.out)
    model, loc0, grid = build(tok, side)
    prompt = torch.tensor(tok(PROMPT, add_special_tokens=True)["input_ids"])
    person = tok("person", add_special_tokens=False)["input_ids"]
    print("parameters", sum(p.numel() for p in model.parameters()), "prompt", len(prompt), "person", person, flush=True)
    report = []
    train(model, a, prompt, person, loc0, grid, report)
    torch.save(model.state_dict(), os.path.join(a.out, "weights.pt"))
    C.freeze(model)
    report.append(dict(in_half=True, **evaluate(model, C.load([a.test], "tiles"), C.load_boxes([a.test]), prompt, person, loc0)))
    print(json.dumps(report[-1]), flush=True)
    model.eval()
    with torch.no_grad():
        export(model, side, onnx_folder)
        made = goldens(model, C.load([a.test], "tiles")[:200], prompt)
    tok.save_pretrained(a.out)
    model.config.save_pretrained(a.out)
    model.generation_config.save_pretrained(a.out)
    C.write_json(os.path.join(a.out, "preprocessor_config.json"), {
        "do_resize": True, "size": {"height": side, "width": side}, "resample": 3, "do_center_crop": False, "do_rescale": True,
        "rescale_factor": 1 / 255, "do_normalize": True, "image_mean": [0.485, 0.456, 0.406], "image_std": [0.229, 0.224, 0.225],
        "image_seq_length": grid * grid + 1,
    })
    C.write_json(os.path.join(a.out, "golden.json"), {"prompt_ids": prompt.tolist(), "tiles": made})
    C.write_json(os.path.join(a.out, "report.json"), {"arguments": vars(a), "curve": report})


if __name__ == "__main__":
    main()
