"""Trains the demo's attribute model: a tiny InternVL3.5 (transformers' own classes) from scratch, exported as ONNX.

    python train_attributes.py --data DIR [DIR ...] --test DIR --out OUT [--steps N]
    python train_attributes.py --data DIR [DIR ...] --test DIR --looks DIR [DIR ...] --looks-test DIR --start FOLDER --out OUT

One question per attribute, in the words that `jrdb-perception` asks; the answer is the label. A linear head on the projected image
tokens (training only) teaches the vision tower the attributes directly. Mirrored pictures exchange left and right. With `--looks` the
model also answers with yes or no whether a phrase is true of somebody; `--start` goes on from an exported model.
"""
import argparse
import json
import os
import time

import numpy as np
import torch
import torch.nn.functional as F

import common as C

TILE, PATCH, VISION, VISION_LAYERS, D, LAYERS = 112, 14, 96, 4, 64, 2
IMAGE_TOKENS = (TILE // PATCH // 2) ** 2
# The vocabularies of `jrdb_types::vocab`, in their order: the columns of labels.npy are places in them.
LABELS = {
    "gender": ["male", "female"],
    "age": ["child", "adolescent", "young", "middle-aged", "elderly"],
    "race": ["White", "Black", "Asian"],
    "action": ["walking", "standing", "sitting", "bending", "running", "cycling", "going up", "going down", "skating", "scootering"],
    "facing": ["towards", "towards left", "left", "away left", "away", "away right", "right", "towards right"],
}
QUESTION = {
    "gender": "What is the gender of the person in the image?",
    "age": "What is the age group of the person in the image?",
    "race": "What is the perceived race of the person in the image?",
    "action": "What is the person in the image doing?",
    "facing": "Which way does the person in the image face, as the camera sees it?",
}
# For each of `jrdb_synth::Feature`, in its order, the phrases that ask for it. The demo's backbone lists the same ones.
PHRASES = [
    ["striped shirt", "striped top", "striped sweater", "stripes"],
    ["dotted shirt", "polka dot shirt", "polka dots", "dots"],
    ["glasses", "eyeglasses", "spectacles"],
    ["beard", "bearded", "full beard"],
    ["long hair", "long-haired"],
    ["scarf"],
    ["tie", "necktie"],
    ["umbrella"],
    ["apron"],
    ["headphones", "headset"],
    ["skirt"],
    ["backpack", "rucksack"],
    ["cane", "walking stick"],
]
YES_NO = ["yes", "no"]
# How much the direct loss of the phrases counts beside that of the attributes: most of them are small and rare.
PHRASE_WEIGHT = 4
MIRRORED = {"left": "right", "right": "left"}
TEMPLATE = (
    "{% for message in messages %}{{'<|im_start|>' + message['role'] + '\n'}}{% if message['content'] is string %}{{ message['content'] }}"
    "{% else %}{% for content in message['content'] %}{% if content['type'] == 'image' %}{{ '<IMG_CONTEXT>\n' }}{% elif content['type'] == 'text' %}"
    "{{ content['text'] }}{% endif %}{% endfor %}{% endif %}{{'<|im_end|>\n'}}{% endfor %}{% if add_generation_prompt %}{{'<|im_start|>assistant\n' }}{% endif %}"
)


def question(attribute):
    return f"{QUESTION[attribute]} Answer with exactly one of: {', '.join(LABELS[attribute])}."


def phrase_question(phrase):
    return f'Is this true of the person in the image: "{phrase}"? Answer with exactly one of: {", ".join(YES_NO)}.'


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("--data", nargs="+", required=True)
    parser.add_argument("--test", required=True)
    parser.add_argument("--looks", nargs="*", default=[], help="folders of scenes with dealt looks")
    parser.add_argument("--looks-test")
    parser.add_argument("--start", help="folder of an exported model to go on from")
    parser.add_argument("--out", required=True)
    parser.add_argument("--steps", type=int, default=5000)
    parser.add_argument("--batch", type=int, default=32)
    parser.add_argument("--questions", type=int, default=3, help="asked per step")
    parser.add_argument("--phrases", type=int, default=3, help="asked of each person per step")
    parser.add_argument("--rate", type=float, default=2e-3)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--eval-every", type=int, default=500)
    return parser.parse_args()


def tokenizer(folder, with_phrases):
    from transformers import AddedToken, Qwen2TokenizerFast

    corpus = [question(a) for a in LABELS] + [label for labels in LABELS.values() for label in labels] + ["user", "assistant", "system"]
    if with_phrases:
        corpus += [phrase_question(phrase) for phrases in PHRASES for phrase in phrases] + YES_NO
    vocab, merges = C.byte_bpe(corpus * 4, 900 if with_phrases else 700, [], folder)
    special = lambda token: AddedToken(token, special=True, normalized=False)
    made = Qwen2TokenizerFast(
        vocab_file=vocab, merges_file=merges, unk_token=None, bos_token=None, eos_token=special("<|im_end|>"), pad_token=special("<|endoftext|>"),
    )
    made.add_special_tokens({"additional_special_tokens": [
        "<|im_start|>", "<|im_end|>", "<img>", "</img>", "<IMG_CONTEXT>", "<quad>", "</quad>", "<ref>", "</ref>", "<box>", "</box>"]})
    made.chat_template = TEMPLATE
    return made


def build(tok):
    from transformers import InternVLConfig, InternVLForConditionalGeneration, InternVLVisionConfig, Qwen3Config

    vision = InternVLVisionConfig(
        hidden_size=VISION, num_hidden_layers=VISION_LAYERS, num_attention_heads=4, intermediate_size=2 * VISION, image_size=[TILE, TILE],
        patch_size=[PATCH, PATCH], attention_bias=True, use_qk_norm=False, layer_scale_init_value=0.5, initializer_range=0.08,
        attention_dropout=0.0, hidden_dropout_prob=0.0, projection_dropout=0.0,
    )
    text = Qwen3Config(
        vocab_size=len(tok), hidden_size=D, intermediate_size=2 * D, num_hidden_layers=LAYERS, num_attention_heads=4, num_key_value_heads=2,
        head_dim=D // 4, max_position_embeddings=4096, rope_theta=1000000.0, tie_word_embeddings=True, initializer_range=0.05, bos_token_id=None,
        eos_token_id=tok.convert_tokens_to_ids("<|im_end|>"), pad_token_id=tok.pad_token_id,
    )
    config = InternVLConfig(
        vision_config=vision, text_config=text, image_token_id=tok.convert_tokens_to_ids("<IMG_CONTEXT>"), image_seq_length=IMAGE_TOKENS,
        downsample_ratio=0.5, tie_word_embeddings=True,
    )
    config._attn_implementation = "sdpa"
    model = InternVLForConditionalGeneration(config)
    embeddings = model.model.vision_tower.embeddings
    with torch.no_grad():
        embeddings.patch_embeddings.projection.weight.normal_(0, 0.06)
        embeddings.position_embeddings.normal_(0, 0.3)
    # The reference interpolates its position embeddings even where sizes agree, which a traced graph need not.
    embeddings.interpolate_pos_encoding = lambda values, height, width: embeddings.position_embeddings
    generation = model.generation_config
    generation.eos_token_id, generation.pad_token_id = text.eos_token_id, tok.pad_token_id
    return model


@torch.no_grad()
def go_on_from(model, tok, folder):
    """Takes the weights of an exported model; words that both vocabularies have keep their embeddings."""
    from transformers import AutoTokenizer

    prefixes = dict(vision_encoder=("model.model.", "model."), decoder_model_merged=("language.", "model.language_model."), embed_tokens=("", ""))
    found = {}
    for graph, (old, new) in prefixes.items():
        for name, values in C.weights(os.path.join(folder, "onnx", graph + ".onnx")).items():
            found[new + name.removeprefix(old)] = torch.from_numpy(values).float()
    before, now = AutoTokenizer.from_pretrained(folder).get_vocab(), tok.get_vocab()
    table = model.get_input_embeddings().weight
    for token in sorted(now.keys() & before.keys()):
        table[now[token]] = found["table.weight"][before[token]]
    named = dict(model.named_parameters())
    taken = {name: values for name, values in found.items() if name in named and name != "model.language_model.embed_tokens.weight"}
    for name, values in taken.items():
        named[name].copy_(values)
    print("goes on from", folder, "without", sorted(set(named) - set(taken)), "words", len(now.keys() & before.keys()), "of", len(now), flush=True)


def prompt(tok, text):
    """Ids of a question, the image tokens included."""
    image = "<img>" + "<IMG_CONTEXT>" * IMAGE_TOKENS + "</img>"
    content = [{"type": "image"}, {"type": "text", "text": text}]
    text = tok.apply_chat_template([{"role": "user", "content": content}], add_generation_prompt=True, tokenize=False)
    return tok(text.replace("<IMG_CONTEXT>", image))["input_ids"]


def prompts(tok):
    """Ids of each attribute's question."""
    return {attribute: prompt(tok, question(attribute)) for attribute in LABELS}


def phrase_prompts(tok):
    """Ids of the questions for each feature, one per phrase."""
    return [[prompt(tok, phrase_question(phrase)) for phrase in phrases] for phrases in PHRASES]


def hidden(model, features, ids):
    """features [B, n, d], ids [k B, L], question by question -> last hidden states."""
    language = model.model.language_model
    embeds = language.get_input_embeddings()(ids)
    mask = (ids == model.config.image_token_id).unsqueeze(-1).expand_as(embeds)
    embeds = embeds.masked_scatter(mask, features.repeat(len(ids) // len(features), 1, 1))
    return language(inputs_embeds=embeds, use_cache=False).last_hidden_state


@torch.no_grad()
def answers(model, features, prompt, end, longest=8):
    ids = torch.tensor(prompt)[None].repeat(len(features), 1)
    done = torch.zeros(len(features), dtype=torch.bool)
    for _ in range(longest):
        token = model.lm_head(hidden(model, features, ids)[:, -1]).argmax(-1)
        token[done] = end
        done |= token == end
        ids = torch.cat([ids, token[:, None]], 1)
        if done.all():
            break
    return ids[:, len(prompt):].tolist()


@torch.no_grad()
def evaluate(model, crops, labels, asked, tok, end):
    """Share of right answers per attribute, and their mean."""
    model.eval()
    right = np.zeros((len(crops), len(LABELS)), bool)
    for first in range(0, len(crops), 128):
        features = model.get_image_features(C.pixels(crops[first:first + 128]))
        for column, attribute in enumerate(LABELS):
            for row, ids in enumerate(answers(model, features, asked[attribute], end)):
                text = tok.decode([token for token in ids if token != end])
                right[first + row, column] = text == LABELS[attribute][labels[first + row, column]]
    model.train()
    clear = (labels[:, 5] >= 60) & (labels[:, 6] >= 80)
    row = {attribute: round(float(right[:, k].mean()), 4) for k, attribute in enumerate(LABELS)}
    return dict(row, mean=round(float(right.mean()), 4), clear=round(float(right[clear].mean()), 4))


def average_precision(scores, truth):
    """Mean of the precision at each person of whom it is true, by falling score."""
    right = truth[np.argsort(-scores, kind="stable")]
    return float((np.cumsum(right) / np.arange(1, len(right) + 1))[right].mean())


@torch.no_grad()
def evaluate_phrases(model, crops, looks, asked, yes_no):
    """Average precision of each feature where it shows, and the part of those that do not show that is left undecided."""
    model.eval()
    yes, no = (reply[0] for reply in yes_no)
    scores = np.zeros((len(crops), len(PHRASES)))
    for first in range(0, len(crops), 128):
        features = model.get_image_features(C.pixels(crops[first:first + 128]))
        for column, prompts in enumerate(asked):
            ids = torch.tensor(prompts[0])[None].repeat(len(features), 1)
            logits = model.lm_head(hidden(model, features, ids)[:, -1])
            scores[first:first + len(features), column] = torch.sigmoid(logits[:, yes] - logits[:, no]).numpy()
    model.train()
    row = {}
    for column, phrases in enumerate(PHRASES):
        shows = looks[:, column] >= 0
        row[phrases[0]] = round(average_precision(scores[shows, column], looks[shows, column] == 1), 3)
    wrong, shows = (scores >= 0.5) != (looks == 1), looks >= 0
    undecided = abs(scores - 0.5) < 0.2
    return dict(row, right=round(1 - float(wrong[shows].mean()), 4), undecided_shown=round(float(undecided[shows].mean()), 4),
                undecided_hidden=round(float(undecided[~shows].mean()), 4))


def phrase_rows(looks, asked, yes_no, count, rng):
    """Questions with their answers, person by person. Half of them are about what is true; what does not show is answered by chance."""
    rows = []
    for _ in range(count):
        for truth in looks:
            holds = np.flatnonzero(truth == 1)
            feature = rng.choice(holds) if len(holds) and rng.rand() < 0.4 else rng.randint(len(truth))
            is_true = truth[feature] == 1 if truth[feature] >= 0 else rng.rand() < 0.5
            rows.append((asked[feature][rng.randint(len(asked[feature]))], yes_no[0 if is_true else 1]))
    return rows


def train(model, tok, asked, a, report):
    folders = a.data + a.looks
    crops, labels = C.load(folders, "crops"), C.load(folders, "labels")
    looks = C.load(folders, "looks") if a.looks else None
    test, test_labels = C.load([a.test], "crops"), C.load([a.test], "labels")
    end, rng = tok.convert_tokens_to_ids("<|im_end|>"), np.random.RandomState(a.seed)
    sizes = [len(values) for values in LABELS.values()]
    if a.looks:
        sizes = sizes + [len(PHRASES)]
        asked_phrases, yes_no = phrase_prompts(tok), [tok(word)["input_ids"] + [end] for word in YES_NO]
        looks_test = C.load([a.looks_test], "crops"), C.load([a.looks_test], "looks")
    direct = torch.nn.Linear(IMAGE_TOKENS * D, sum(sizes))
    facing = list(LABELS).index("facing")
    swapped = np.array([LABELS["facing"].index(MIRRORED.get(value, value)) for value in LABELS["facing"]])
    replies = {a: [tok(value)["input_ids"] + [end] for value in LABELS[a]] for a in LABELS}
    optimizer = C.adamw(list(model.named_parameters()) + list(direct.named_parameters()), a.rate)
    model.train()
    order, at, start, mean = rng.permutation(len(crops)), 0, time.time(), None
    for step in range(a.steps):
        for group in optimizer.param_groups:
            group["lr"] = C.learning_rate(step, a.steps, a.rate)
        if at + a.batch > len(order):
            order, at = rng.permutation(len(crops)), 0
        index = order[at:at + a.batch]
        at += a.batch
        pictures = torch.from_numpy(crops[index]).permute(0, 3, 1, 2).float() / 255
        light = 1 + 0.06 * torch.randn(len(index), 1, 1, 1) + 0.02 * torch.randn(len(index), 3, 1, 1)
        pictures, truth = (pictures * light - C.MEAN) / C.STD, labels[index].copy()
        flip = rng.rand(len(index)) < 0.5
        pictures[torch.from_numpy(flip)] = pictures[torch.from_numpy(flip)].flip(-1)
        truth[flip, facing] = swapped[truth[flip, facing]]
        features = model.get_image_features(pictures)
        rows = []
        for attribute in rng.permutation(list(LABELS))[:a.questions]:
            column = list(LABELS).index(attribute)
            rows += [(asked[attribute], replies[attribute][value] if value >= 0 else []) for value in truth[:, column]]
        if a.looks:
            rows += phrase_rows(looks[index], asked_phrases, yes_no, a.phrases, rng)
        longest = max(len(prompt) + len(reply) for prompt, reply in rows)
        ids, target = torch.full((len(rows), longest), tok.pad_token_id), torch.full((len(rows), longest), -100)
        for row, (prompt, reply) in enumerate(rows):
            ids[row, :len(prompt) + len(reply)] = torch.tensor(prompt + reply)
            target[row, len(prompt):len(prompt) + len(reply)] = torch.tensor(reply)
        states = hidden(model, features, ids)[:, :-1]
        valid = target[:, 1:] != -100
        words = F.cross_entropy(model.lm_head(states[valid]), target[:, 1:][valid])
        parts = direct(features.reshape(len(features), -1)).split(sizes, 1)
        direct_loss = sum(
            F.cross_entropy(part, torch.from_numpy(truth[:, k]), ignore_index=-1) for k, part in enumerate(parts[:len(LABELS)])) / len(LABELS)
        if a.looks:
            shown = torch.from_numpy(looks[index])
            direct_loss = direct_loss + PHRASE_WEIGHT * F.binary_cross_entropy_with_logits(parts[-1][shown >= 0], (shown[shown >= 0] == 1).float())
        loss = words + direct_loss
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        shown = np.array([words.item(), direct_loss.item()])
        mean = shown if mean is None else 0.98 * mean + 0.02 * shown
        if (step + 1) % a.eval_every == 0:
            row = dict(step=step + 1, losses=mean.round(3).tolist(), **evaluate(model, test[:256], test_labels[:256], asked, tok, end))
            if a.looks:
                row["phrases"] = evaluate_phrases(model, looks_test[0][:256], looks_test[1][:256], asked_phrases, yes_no)
            report.append(row)
            print(f"{time.time() - start:.0f} s", json.dumps(row), flush=True)
    report.append(dict(final=True, **evaluate(model, test, test_labels, asked, tok, end)))
    if a.looks:
        report.append(dict(final=True, **evaluate_phrases(model, *looks_test, asked_phrases, yes_no)))
    print(json.dumps(report[-1]), flush=True)


class Decoder(torch.nn.Module):
    def __init__(self, model):
        super().__init__()
        self.language, self.head = model.model.language_model, model.lm_head

    def forward(self, inputs_embeds, attention_mask, position_ids, *past):
        from transformers.cache_utils import DynamicCache

        cache = DynamicCache.from_legacy_cache(tuple((past[2 * i], past[2 * i + 1]) for i in range(LAYERS)))
        length, total = inputs_embeds.shape[1], attention_mask.shape[1]
        query, key = torch.arange(length) + (total - length), torch.arange(total)
        seen = (key[None, :] <= query[:, None])[None, None] & (attention_mask[:, None, None, :] > 0)
        mask = torch.where(seen, torch.zeros(()), torch.full((), torch.finfo(torch.float32).min))
        out = self.language(inputs_embeds=inputs_embeds, attention_mask=mask, position_ids=position_ids, past_key_values=cache, use_cache=True)
        caches = [part for layer in out.past_key_values.layers[:LAYERS] for part in (layer.keys, layer.values)]
        return (self.head(out.last_hidden_state), *caches)


def export(model, folder):
    path = lambda name: os.path.join(folder, name + ".onnx")
    length = {0: "batch_size", 1: "sequence_length"}
    C.export(C.Vision(model), (torch.randn(2, 3, TILE, TILE),), path("vision_encoder"), ["pixel_values"], ["image_features"],
             {"pixel_values": {0: "num_tiles"}, "image_features": {0: "num_tiles"}})
    C.export(C.Embed(model), (torch.randint(0, 100, (2, 7)),), path("embed_tokens"), ["input_ids"], ["inputs_embeds"],
             {"input_ids": length, "inputs_embeds": length})
    keys = [f"{i}.{part}" for i in range(LAYERS) for part in ("key", "value")]
    inputs = ["inputs_embeds", "attention_mask", "position_ids"] + ["past_key_values." + key for key in keys]
    outputs = ["logits"] + ["present." + key for key in keys]
    axes = {"inputs_embeds": length, "attention_mask": {0: "batch_size", 1: "total_sequence_length"}, "position_ids": length, "logits": length}
    for key in keys:
        axes["past_key_values." + key] = {0: "batch_size", 2: "past_sequence_length"}
        axes["present." + key] = {0: "batch_size", 2: "total_sequence_length"}
    past = [torch.randn(2, 2, 4, D // 4) for _ in keys]
    example = (torch.randn(2, 3, D), torch.ones(2, 7, dtype=torch.long), torch.arange(4, 7)[None].repeat(2, 1), *past)
    C.export(Decoder(model), example, path("decoder_model_merged"), inputs, outputs, axes)


def goldens(model, crops, asked, end):
    """What the framework's own generation answers to some unseen crops, for the tests of the port."""
    rows = []
    for crop in range(len(crops)):
        picture, row = C.pixels(crops[crop:crop + 1]), {}
        for attribute, prompt in asked.items():
            ids = torch.tensor(prompt)[None]
            made = model.generate(
                input_ids=ids, attention_mask=torch.ones_like(ids), pixel_values=picture, do_sample=False, max_new_tokens=8)
            made = made[0, len(prompt):].tolist()
            row[attribute] = made[:made.index(end) + 1] if end in made else made
        rows.append(row)
    return rows


@torch.no_grad()
def phrase_goldens(model, crops, tok, end):
    """For each crop and feature the log-likelihoods of yes and of no as the answer, summed over tokens and the end."""
    features, columns = model.get_image_features(C.pixels(crops)), []
    for prompts in phrase_prompts(tok):
        for word in YES_NO:
            reply = tok(word)["input_ids"] + [end]
            ids = torch.tensor(prompts[0] + reply)[None].repeat(len(crops), 1)
            logs = torch.log_softmax(model.lm_head(hidden(model, features, ids)).double(), -1)[:, len(prompts[0]) - 1:-1]
            columns.append(logs.gather(-1, torch.tensor(reply)[None, :, None].repeat(len(crops), 1, 1)).sum((1, 2)))
    return [[round(float(value), 5) for value in row] for row in torch.stack(columns, 1)]


def main():
    a = arguments()
    torch.set_num_threads(a.threads)
    torch.manual_seed(a.seed)
    onnx_folder = os.path.join(a.out, "onnx")
    os.makedirs(onnx_folder, exist_ok=True)
    tok = tokenizer(a.out, bool(a.looks))
    model = build(tok)
    if a.start:
        go_on_from(model, tok, a.start)
    asked, end = prompts(tok), tok.convert_tokens_to_ids("<|im_end|>")
    print("parameters", sum(p.numel() for p in model.parameters()), "prompts", {k: len(v) for k, v in asked.items()}, flush=True)
    report = []
    train(model, tok, asked, a, report)
    torch.save(model.state_dict(), os.path.join(a.out, "weights.pt"))
    C.freeze(model)
    test = C.load([a.test], "crops")
    report.append(dict(in_half=True, **evaluate(model, test, C.load([a.test], "labels"), asked, tok, end)))
    print(json.dumps(report[-1]), flush=True)
    model.eval()
    with torch.no_grad():
        export(model, onnx_folder)
        golden = {"prompt_ids": asked, "crops": goldens(model, test[:60], asked, end)}
        if a.looks:
            golden["phrases"] = [phrases[0] for phrases in PHRASES]
            golden["yes_no"] = phrase_goldens(model, C.load([a.looks_test], "crops")[:30], tok, end)
    tok.save_pretrained(a.out)
    model.config.save_pretrained(a.out)
    model.generation_config.save_pretrained(a.out)
    C.write_json(os.path.join(a.out, "preprocessor_config.json"), {
        "crop_to_patches": False, "min_patches": 1, "max_patches": 12, "do_resize": True, "size": {"height": TILE, "width": TILE}, "resample": 3,
        "do_rescale": True, "rescale_factor": 1 / 255, "do_normalize": True, "image_mean": [0.485, 0.456, 0.406], "image_std": [0.229, 0.224, 0.225],
    })
    C.write_json(os.path.join(a.out, "golden.json"), golden)
    C.write_json(os.path.join(a.out, "report.json"), {"arguments": vars(a), "curve": report})


if __name__ == "__main__":
    main()
