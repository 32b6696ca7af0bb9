"""What the framework's own InternVL3.5 makes of yes and no, for the test `conformance_internvl_yes_no`.

    python yes_no_golden.py FOLDER OUT.json

FOLDER holds a tiny model in our export's layout and pictures (*.png). The weights of its graphs are put into the framework's classes,
so the numbers come from the original's code, not from the graphs. For each picture and phrase: the ids of the prompt (runs of image
tokens as [-1, length]) and the log-likelihood of each answer, summed over its tokens and the end.
"""
import glob
import json
import os
import sys

import numpy as np
import onnx
import torch
from onnx import numpy_helper
from PIL import Image

# The words of `jrdb_perception::prompts::{phrase_question, yes_no}`.
ASKED = [("striped shirt", "person"), ("wearing glasses", "person"), ("smiling", "person"), ("wooden", "chair")]
ANSWERS = ["yes", "Yes", "no", "No"]


def question(phrase, category):
    return f'Is this true of the {category} in the image: "{phrase}"? Answer with exactly one of: yes, no.'


def weights(path, old, new):
    """A graph's weights by their names in the framework: those of linear layers are named by their nodes, equal ones are stored once."""
    graph = onnx.load(path).graph
    found = {one.name: numpy_helper.to_array(one) for one in graph.initializer}
    for node in graph.node:
        if node.op_type == "Identity" and node.input[0] in found:
            found[node.output[0]] = found[node.input[0]]
        if node.op_type == "MatMul" and node.input[1] in found:
            name = node.name.strip("/").rsplit("/", 1)[0].replace("/", ".") + ".weight"
            found[name] = found[node.input[1]].T
    return {new + name.removeprefix(old): torch.tensor(values) for name, values in found.items()}


def load(folder):
    from transformers import AutoConfig, InternVLForConditionalGeneration

    config = AutoConfig.from_pretrained(folder)
    config._attn_implementation = "eager"
    model = InternVLForConditionalGeneration(config).eval()
    path = lambda name: os.path.join(folder, "onnx", name + ".onnx")
    known = dict(weights(path("vision_encoder"), "m.model.", "model."))
    known.update(weights(path("decoder_model_merged"), "l.", "model.language_model."))
    (table,) = weights(path("embed_tokens"), "", "").values()
    known["model.language_model.embed_tokens.weight"] = table
    named = dict(model.named_parameters())
    missing = sorted(named.keys() - known.keys())
    if missing:
        raise SystemExit(f"the graphs lack {missing}")
    with torch.no_grad():
        for name, parameter in named.items():
            parameter.copy_(known[name])
    return model


def compact(ids, image):
    made = []
    for one in ids:
        if one == image and made and isinstance(made[-1], list):
            made[-1][1] += 1
        else:
            made.append([-1, 1] if one == image else one)
    return made


def pixels(path, folder):
    """A picture as one tile; the framework's preparation has a test of its own, `conformance_internvl_tiles`."""
    with open(os.path.join(folder, "preprocessor_config.json")) as file:
        config = json.load(file)
    size = config["size"]["width"], config["size"]["height"]
    picture = np.asarray(Image.open(path).convert("RGB").resize(size, Image.BICUBIC), np.float32) * np.float32(config["rescale_factor"])
    normal = (picture - np.float32(config["image_mean"])) / np.float32(config["image_std"])
    return torch.from_numpy(normal.transpose(2, 0, 1)[None].copy())


def main():
    from transformers import AutoTokenizer

    folder, out = sys.argv[1:]
    torch.set_num_threads(1)
    tokenizer, model = AutoTokenizer.from_pretrained(folder), load(folder)
    image_token = model.config.image_token_id
    end = tokenizer.convert_tokens_to_ids("<|im_end|>")
    cases = []
    for path in sorted(glob.glob(os.path.join(folder, "*.png"))):
        tile = pixels(path, folder)
        for phrase, category in ASKED:
            image = "<img>" + "<IMG_CONTEXT>" * model.config.image_seq_length + "</img>"
            text = f"<|im_start|>user\n{image}\n{question(phrase, category)}<|im_end|>\n<|im_start|>assistant\n"
            prompt, sums = tokenizer(text)["input_ids"], {}
            for answer in ANSWERS:
                reply = tokenizer(answer)["input_ids"] + [end]
                ids = torch.tensor([prompt + reply])
                with torch.no_grad():
                    logits = model(input_ids=ids, attention_mask=torch.ones_like(ids), pixel_values=tile).logits[0]
                logs = torch.log_softmax(logits.double(), -1)[len(prompt) - 1:-1]
                sums[answer] = round(float(sum(row[token] for row, token in zip(logs, reply))), 6)
            name = os.path.splitext(os.path.basename(path))[0]
            cases.append({"image": name, "phrase": phrase, "category": category, "prompt": compact(prompt, image_token), "log_likelihoods": sums})
    with open(out, "w") as file:
        file.write("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]\n")


if __name__ == "__main__":
    np.seterr(all="raise")
    main()
