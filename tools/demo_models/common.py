"""What training of both demo models shares: arrays, byte-level vocabularies, half-precision storage, ONNX export."""
import json
import os

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper

MEAN = torch.tensor([0.485, 0.456, 0.406]).view(1, 3, 1, 1)
STD = torch.tensor([0.229, 0.224, 0.225]).view(1, 3, 1, 1)
OPSET = 17
# Initialisers with fewer numbers than this stay in single precision: they weigh nothing.
HALF_MIN = 64


def load(folders, name):
    """The same array of several data folders, one after the other."""
    return np.concatenate([np.load(os.path.join(folder, name + ".npy")) for folder in folders])


def load_boxes(folders):
    """Per tile the rows x0, y0, x1, y1 (parts of the tile), visible share, rows of pixels."""
    per_tile = []
    for folder in folders:
        tiles = len(np.load(os.path.join(folder, "tiles.npy"), mmap_mode="r"))
        rows = np.load(os.path.join(folder, "boxes.npy"))
        per_tile += [rows[rows[:, 0] == tile][:, 1:] for tile in range(tiles)]
    return per_tile


def pixels(pictures):
    """u8 [N, H, W, 3] -> normalised f32 [N, 3, H, W]."""
    return (torch.from_numpy(pictures).permute(0, 3, 1, 2).float() / 255 - MEAN) / STD


def learning_rate(step, steps, peak):
    """150 steps of warm-up, then a cosine down to 2 %."""
    return peak * min(1.0, (step + 1) / 150) * (0.02 + 0.98 * 0.5 * (1 + np.cos(np.pi * step / steps)))


def adamw(named, rate):
    """Weight decay on matrices only, not on embeddings."""
    decays = lambda name, p: p.dim() > 1 and "embed" not in name
    groups = [
        dict(params=[p for name, p in named if decays(name, p)], weight_decay=0.05),
        dict(params=[p for name, p in named if not decays(name, p)], weight_decay=0.0),
    ]
    return torch.optim.AdamW(groups, lr=rate, betas=(0.9, 0.98))


def byte_bpe(corpus, size, special, folder):
    """Trains a byte-level BPE and writes vocab.json and merges.txt."""
    from tokenizers import ByteLevelBPETokenizer

    trained = ByteLevelBPETokenizer(add_prefix_space=False)
    trained.train_from_iterator(corpus, vocab_size=size, min_frequency=2, special_tokens=special, show_progress=False)
    model = json.loads(trained._tokenizer.to_str())["model"]
    merges = [merge if isinstance(merge, str) else " ".join(merge) for merge in model["merges"]]
    paths = os.path.join(folder, "vocab.json"), os.path.join(folder, "merges.txt")
    with open(paths[0], "w") as file:
        json.dump(model["vocab"], file)
    with open(paths[1], "w") as file:
        file.write("#version: 0.2\n" + "\n".join(merges) + "\n")
    return paths


def round_to_half(model):
    """Rounds every weight that is stored in half precision, so that the framework computes with what the files hold."""
    with torch.no_grad():
        for parameter in model.parameters():
            if parameter.numel() >= HALF_MIN:
                parameter.copy_(parameter.half().float())


def store_in_half(path):
    """Rewrites the large single-precision initialisers of an ONNX file as half precision with a Cast behind each."""
    model = onnx.load(path)
    casts = []
    for tensor in model.graph.initializer:
        if tensor.data_type != TensorProto.FLOAT or np.prod(tensor.dims) < HALF_MIN:
            continue
        name, values = tensor.name, numpy_helper.to_array(tensor)
        tensor.CopyFrom(numpy_helper.from_array(values.astype(np.float16), name + ".f16"))
        casts.append(helper.make_node("Cast", [name + ".f16"], [name], name=name + ".cast", to=TensorProto.FLOAT))
    nodes = casts + list(model.graph.node)
    del model.graph.node[:]
    model.graph.node.extend(nodes)
    # Names of the framework's modules say nothing to a reader of the file, and cost space.
    for node in model.graph.node:
        node.ClearField("doc_string")
    onnx.checker.check_model(model)
    onnx.save(model, path)


def weights(path):
    """The weights of an exported graph by their names in the framework; those of linear layers are named by their nodes."""
    model = onnx.load(path)
    found = {tensor.name.removesuffix(".f16"): numpy_helper.to_array(tensor) for tensor in model.graph.initializer}
    for node in model.graph.node:
        if node.op_type == "MatMul" and node.input[1] in found:
            found[node.name.strip("/").rsplit("/", 1)[0].replace("/", ".") + ".weight"] = found[node.input[1]].T.copy()
    return found


def export(module, arguments, path, inputs, outputs, axes):
    torch.onnx.export(
        module.eval(), arguments, path, input_names=inputs, output_names=outputs, dynamic_axes=axes,
        opset_version=OPSET, do_constant_folding=True, dynamo=False,
    )
    store_in_half(path)


def freeze(model):
    """Ready for export: no dropout, no gradients, plain attention, weights as they are stored."""
    model.eval()
    for module in model.modules():
        if hasattr(module, "config"):
            module.config._attn_implementation = "eager"
    for parameter in model.parameters():
        parameter.requires_grad_(False)
    round_to_half(model)


def session(path):
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.log_severity_level, options.intra_op_num_threads = 3, 1
    return onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])


def write_json(path, value):
    with open(path, "w") as file:
        json.dump(value, file, indent=1)
        file.write("\n")


class Embed(torch.nn.Module):
    """Ids to embeddings."""

    def __init__(self, model):
        super().__init__()
        self.table = model.get_input_embeddings()

    def forward(self, input_ids):
        return self.table(input_ids)


class Vision(torch.nn.Module):
    """Pixels to image tokens in the text model's space."""

    def __init__(self, model):
        super().__init__()
        self.model = model

    def forward(self, pixel_values):
        return self.model.get_image_features(pixel_values)
