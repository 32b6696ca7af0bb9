"""Exports InternVL3.5 (transformers' own form, repositories with -HF) as the three graphs that `jrdb-perception` reads, and verifies them.

    python internvl.py SOURCE OUT [--half]

Writes OUT/config.json, generation_config.json, preprocessor_config.json, tokenizer.json and OUT/onnx/{vision_encoder,embed_tokens,
decoder_model_merged}.onnx. Text models of Qwen2's and Qwen3's kind; not those of experts.
"""
import torch

import causal
import common as C

NEEDED = ["<|im_start|>", "<|im_end|>", "<img>", "</img>", "<IMG_CONTEXT>"]


class Vision(torch.nn.Module):
    """Tiles to image tokens in the text model's space."""

    def __init__(self, model):
        super().__init__()
        self.model = model

    def forward(self, pixel_values):
        return self.model.get_image_features(pixel_values)


def load(a):
    from transformers import InternVLForConditionalGeneration

    model = C.load(InternVLForConditionalGeneration, a)
    causal.check(model.config.text_config)
    # The original interpolates its position embeddings when it is traced, even where sizes agree.
    embeddings = model.model.vision_tower.embeddings
    embeddings.interpolate_pos_encoding = lambda values, height, width: embeddings.position_embeddings
    return model


def export(model, a):
    height, width = model.config.vision_config.image_size
    tiles = {0: "num_tiles"}
    C.export(Vision(model), (torch.randn(2, 3, height, width),), "vision_encoder", ["pixel_values"], ["image_features"],
             {"pixel_values": tiles, "image_features": tiles}, a)
    causal.export(model, 2, a)


def write_files(model, a):
    """The files beside the graphs; the tokenizer."""
    tokenizer = C.write_tokenizer(a, NEEDED)
    if tokenizer.convert_tokens_to_ids("<IMG_CONTEXT>") != model.config.image_token_id:
        raise SystemExit("config.json names another image token than <IMG_CONTEXT>")
    height, width = model.config.vision_config.image_size
    picture = C.picture_config(a)
    if picture["size"] != {"height": height, "width": width}:
        raise SystemExit(f"the picture's size is {picture['size']}, the vision model's {[height, width]}")
    C.write_config(a, model.config)
    C.write_json(a, "preprocessor_config.json", picture)
    causal.write_generation(model, tokenizer, a)
    return tokenizer


def prompt(question, tiles, model):
    image = "<IMG_CONTEXT>" * (tiles * model.config.image_seq_length)
    return f"<|im_start|>user\n<img>{image}</img>\n{question}<|im_end|>\n<|im_start|>assistant\n"


def places(ids, mask):
    """Counted from the first column on, as the original does without being told."""
    total = mask.shape[1]
    return torch.arange(total - ids.shape[1], total)[None].repeat(len(ids), 1)


def verify(model, tokenizer, a):
    differences, vision = C.Differences(), C.session(a, "vision_encoder")
    graphs = causal.Graphs(model.config.text_config, a)
    height, width = model.config.vision_config.image_size
    question = causal.QUESTIONS
    # Questions about a picture of so many tiles each.
    for asked in ([(question[0], 1)], [(question[1], 3)], [(question[1], 1), (question[2], 1)]):
        pixels = torch.randn(sum(tiles for _, tiles in asked), 3, height, width)
        features = vision.run(None, {"pixel_values": pixels.numpy()})[0]
        differences.add("image features", features, model.get_image_features(pixels))
        prompts = causal.batch(tokenizer, [prompt(text, tiles, model) for text, tiles in asked])
        causal.compare(model, graphs, prompts, {"pixel_values": pixels}, features, places, differences)
    differences.finish()


def main():
    a = C.parser(__doc__).parse_args()
    C.prepare(a)
    model = load(a)
    tokenizer = write_files(model, a)
    export(model, a)
    verify(model, tokenizer, a)


if __name__ == "__main__":
    main()
