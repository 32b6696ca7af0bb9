"""The text half of both vision-language models: embeddings, a decoder with caches, and their comparison with the original."""
import json

import numpy as np
import torch

import common as C

STEPS = 3
QUESTIONS = [
    "What is the person in the image doing?",
    "What is the age group of the person in the image? Answer with exactly one of: child, adolescent, young, middle-aged, elderly.",
    "Who?",
]
TEXT_MODELS = ("qwen2", "qwen3", "qwen2_5_vl_text")


class Embed(torch.nn.Module):
    """Ids to embeddings."""

    def __init__(self, model):
        super().__init__()
        self.table = model.get_input_embeddings()

    def forward(self, input_ids):
        return self.table(input_ids)


class Decoder(torch.nn.Module):
    """Embeddings and caches, which may be of nothing, to scores and longer caches. `num_logits_to_keep` 0 scores every place."""

    def __init__(self, model):
        super().__init__()
        self.language, self.head = model.model.language_model, model.lm_head

    def forward(self, inputs_embeds, attention_mask, position_ids, num_logits_to_keep, *past):
        from transformers.cache_utils import DynamicCache

        cache = DynamicCache.from_legacy_cache(tuple(zip(past[::2], past[1::2])))
        length, total = inputs_embeds.shape[1], attention_mask.shape[1]
        query, key = torch.arange(length) + (total - length), torch.arange(total)
        seen = (key[None, :] <= query[:, None])[None, None] & (attention_mask[:, None, None, :] > 0)
        mask = torch.where(seen, torch.zeros(()), torch.full((), torch.finfo(torch.float32).min))
        out = self.language(
            inputs_embeds=inputs_embeds, attention_mask={"full_attention": mask}, position_ids=position_ids, past_key_values=cache, use_cache=True)
        first = torch.where(num_logits_to_keep > 0, length - num_logits_to_keep, 0).clamp(min=0)
        caches = [part for layer in out.past_key_values.layers for part in (layer.keys, layer.values)]
        return (self.head(out.last_hidden_state[:, first:]), *caches)


def cache_shape(text):
    """Heads of a cache and the width of each."""
    return text.num_key_value_heads, getattr(text, "head_dim", None) or text.hidden_size // text.num_attention_heads


def cache_names(text):
    return [f"{layer}.{part}" for layer in range(text.num_hidden_layers) for part in ("key", "value")]


def check(text):
    """Refuses text models that a trace would get wrong: experts and sliding windows depend on the input."""
    if text.model_type not in TEXT_MODELS:
        raise SystemExit(f"expected a text model of {', '.join(TEXT_MODELS)}, found {text.model_type}")
    if any(kind != "full_attention" for kind in text.layer_types):
        raise SystemExit("text models with sliding windows are not supported")


def export(model, axes_of_places, a):
    """`embed_tokens` and `decoder_model_merged`. Places are `[batch, length]`, or `[3, batch, length]` if `axes_of_places` is 3."""
    text = model.config.text_config
    length, keys = {0: "batch_size", 1: "sequence_length"}, cache_names(text)
    C.export(Embed(model), (torch.randint(0, 100, (2, 7)),), "embed_tokens", ["input_ids"], ["inputs_embeds"],
             {"input_ids": length, "inputs_embeds": length}, a)
    heads, width = cache_shape(text)
    places = torch.arange(4, 7)[None].repeat(2, 1)
    places = places[None].repeat(3, 1, 1) if axes_of_places == 3 else places
    inputs = ["inputs_embeds", "attention_mask", "position_ids", "num_logits_to_keep"] + ["past_key_values." + key for key in keys]
    outputs = ["logits"] + ["present." + key for key in keys]
    axes = {
        "inputs_embeds": length, "attention_mask": {0: "batch_size", 1: "total_sequence_length"},
        "position_ids": {places.dim() - 2: "batch_size", places.dim() - 1: "sequence_length"},
        "logits": {0: "batch_size", 1: "scored_length"},
    }
    for key in keys:
        axes["past_key_values." + key] = {0: "batch_size", 2: "past_sequence_length"}
        axes["present." + key] = {0: "batch_size", 2: "total_sequence_length"}
    past = [torch.randn(2, heads, 4, width) for _ in keys]
    example = (torch.randn(2, 3, text.hidden_size), torch.ones(2, 7, dtype=torch.long), places, torch.tensor(2), *past)
    C.export(Decoder(model), example, "decoder_model_merged", inputs, outputs, axes, a)


def write_generation(model, tokenizer, a):
    """Writes `generation_config.json`; a turn's end is among the tokens that end an answer."""
    value = json.loads(model.generation_config.to_json_string())
    ends = value.get("eos_token_id", [])
    ends = [ends] if isinstance(ends, int) else ends
    turn = tokenizer.convert_tokens_to_ids("<|im_end|>")
    value["eos_token_id"] = ends if turn in ends else [turn, *ends]
    C.write_json(a, "generation_config.json", value)


class Graphs:
    """The exported text half in ONNX Runtime."""

    def __init__(self, text, a):
        self.keys, self.empty = cache_names(text), cache_shape(text)
        self.table, self.decoder = C.session(a, "embed_tokens"), C.session(a, "decoder_model_merged")

    def embed(self, ids):
        return self.table.run(None, {"input_ids": ids.numpy()})[0]

    def decode(self, embeds, mask, places, past=None, keep=0):
        heads, width = self.empty
        past = past or [np.zeros((len(embeds), heads, 0, width), np.float32) for _ in self.keys]
        feed = {"inputs_embeds": embeds, "attention_mask": mask.numpy(), "position_ids": places.numpy(), "num_logits_to_keep": np.array(keep)}
        feed |= {"past_key_values." + key: part for key, part in zip(self.keys, past)}
        logits, *caches = self.decoder.run(None, feed)
        return logits, caches


def batch(tokenizer, prompts):
    """Ids and attention mask, shorter prompts filled up at their left."""
    rows = [tokenizer(prompt)["input_ids"] for prompt in prompts]
    longest, filler = max(map(len, rows)), tokenizer.pad_token_id or 0
    ids = torch.tensor([[filler] * (longest - len(row)) + row for row in rows])
    mask = torch.tensor([[0] * (longest - len(row)) + [1] * len(row) for row in rows])
    return ids, mask


def compare(model, graphs, prompts, pictures, features, places, differences):
    """Reads prompts and writes three tokens with caches, the graphs beside the original.

    `prompts` are ids and mask, `pictures` the original's inputs, `features` what the vision graph made of them; `places` gives the places of
    new tokens from their ids and the whole mask.
    """
    ids, mask = prompts
    expected = model(input_ids=ids, attention_mask=mask, use_cache=True, **pictures)
    embeds = graphs.embed(ids)
    embeds[(ids == model.config.image_token_id).numpy()] = features.reshape(-1, features.shape[-1])
    found, past = graphs.decode(embeds, mask, places(ids, mask))
    real = mask.bool().numpy()
    rows = f"{len(ids)} rows" if len(ids) > 1 else "1 row"
    differences.add(f"prefill, {rows}", found[real], expected.logits.numpy()[real])
    last, _ = graphs.decode(embeds, mask, places(ids, mask), keep=1)
    differences.add(f"prefill, {rows}, last place only", last, found[:, -1:])
    for step in range(1, STEPS + 1):
        token = expected.logits[:, -1:].argmax(-1)
        at, mask = torch.tensor([mask.shape[1]]), torch.cat([mask, torch.ones_like(token)], 1)
        expected = model(
            input_ids=token, attention_mask=mask, past_key_values=expected.past_key_values, cache_position=at, use_cache=True)
        found, past = graphs.decode(graphs.embed(token), mask, places(token, mask), past)
        differences.add(f"decoding, {rows}, step {step}", found, expected.logits)
