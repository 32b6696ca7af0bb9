"""What the exporters share: their command line, graphs and how weights are stored, the files beside them, the comparison with the original."""
import argparse
import json
import os
import tempfile
import warnings

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper

OPSET = 17
# A graph and the original may differ by this much, as a part of the largest value where that is above 1.
LIMIT = 1e-3
# Initialisers with fewer numbers than this stay in single precision: they weigh nothing.
HALF_MIN = 64
# One file cannot hold more than 2 GB; some of it is the graph.
SPLIT_ABOVE_MB = 1900
# Tensors with fewer bytes than this stay in the graph even if the weights are beside it.
EXTERNAL_MIN = 1024


def parser(about):
    made = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("source", help="a local folder or the hub id of a checkpoint")
    made.add_argument("out", help="folder for the graphs and the files beside them")
    made.add_argument("--half", action="store_true", help="store weights in half precision; they are computed with in single precision all the same")
    made.add_argument("--split-above", type=float, default=SPLIT_ABOVE_MB, metavar="MB",
                      help="graphs whose weights are larger have them in a file .onnx_data beside them (default %(default)s)")
    made.add_argument("--threads", type=int, default=1)
    return made


def prepare(a):
    """What every exporter begins with. The pictures of the comparison are the same each time."""
    warnings.filterwarnings("ignore")
    torch.set_num_threads(a.threads)
    torch.manual_seed(0)
    torch.set_grad_enabled(False)
    os.makedirs(os.path.join(a.out, "onnx"), exist_ok=True)


def load(kind, a):
    """The model in single precision with plain attention, its weights as they will be stored."""
    model = kind.from_pretrained(a.source, dtype=torch.float32, attn_implementation="eager").eval()
    if a.half:
        round_to_half(model)
    return model


def round_to_half(model):
    """Rounds every weight that is stored in half precision, so that the original computes with what the files hold."""
    for name, weight in model.named_parameters():
        if weight.numel() >= HALF_MIN:
            rounded = weight.half().float()
            if not torch.isfinite(rounded).all():
                raise SystemExit(f"{name} has values beyond half precision: export without --half")
            weight.copy_(rounded)


def store_in_half(model):
    """Stores in half precision the initialisers that lose nothing by it, with a Cast behind each. Tables that tracing made stay as they are."""
    casts = []
    for tensor in model.graph.initializer:
        if tensor.data_type != TensorProto.FLOAT or np.prod(tensor.dims) < HALF_MIN:
            continue
        name, values = tensor.name, numpy_helper.to_array(tensor)
        with np.errstate(over="ignore"):
            rounded = values.astype(np.float16)
        if not np.array_equal(rounded.astype(np.float32), values):
            continue
        tensor.CopyFrom(numpy_helper.from_array(rounded, name + ".f16"))
        casts.append(helper.make_node("Cast", [name + ".f16"], [name], name=name + ".cast", to=TensorProto.FLOAT))
    nodes = casts + list(model.graph.node)
    del model.graph.node[:]
    model.graph.node.extend(nodes)


def save(model, path, split_above_mb):
    """Writes a graph, its weights in a file beside it if they are large."""
    beside = path + "_data"
    for old in (path, beside):
        if os.path.exists(old):
            os.remove(old)
    weights = sum(len(tensor.raw_data) for tensor in model.graph.initializer)
    if weights > split_above_mb * 1e6:
        onnx.save_model(model, path, save_as_external_data=True, all_tensors_to_one_file=True, location=os.path.basename(beside),
                        size_threshold=EXTERNAL_MIN)
    else:
        onnx.save_model(model, path)
    onnx.checker.check_model(path)
    print(f"{os.path.basename(path)}: {weights / 1e6:.1f} MB of weights{' beside it' if os.path.exists(beside) else ''}", flush=True)


def export(module, example, name, inputs, outputs, axes, a):
    """Traces a module into OUT/onnx/NAME.onnx."""
    folder = os.path.join(a.out, "onnx")
    with tempfile.TemporaryDirectory(dir=folder) as traced:
        path = os.path.join(traced, "graph.onnx")
        torch.onnx.export(
            module.eval(), example, path, input_names=inputs, output_names=outputs, dynamic_axes=axes, opset_version=OPSET,
            do_constant_folding=True, dynamo=False,
        )
        model = onnx.load(path)
    # Names of the framework's modules say nothing to a reader of the file, and cost space.
    for node in model.graph.node:
        node.ClearField("doc_string")
    if a.half:
        store_in_half(model)
    save(model, os.path.join(folder, name + ".onnx"), a.split_above)


def session(a, name):
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.log_severity_level, options.intra_op_num_threads = 3, a.threads
    return onnxruntime.InferenceSession(os.path.join(a.out, "onnx", name + ".onnx"), options, providers=["CPUExecutionProvider"])


def write_json(a, name, value):
    with open(os.path.join(a.out, name), "w") as file:
        json.dump(value, file, indent=1)
        file.write("\n")


def write_config(a, config):
    """What differs from the framework's defaults and all that is the model's own; not where the checkpoint lay."""
    value = json.loads(config.to_json_string())
    value.pop("_name_or_path", None)
    write_json(a, "config.json", value)


def picture_config(a):
    """The checkpoint's `preprocessor_config.json` as the processors that work with Pillow have it."""
    from transformers import AutoImageProcessor

    return json.loads(AutoImageProcessor.from_pretrained(a.source, use_fast=False).to_json_string())


def write_tokenizer(a, needed):
    """Writes `tokenizer.json`, added tokens included, after checking that it has the tokens that prompts are made of."""
    from transformers import AutoTokenizer

    tokenizer = AutoTokenizer.from_pretrained(a.source, use_fast=True)
    vocabulary = tokenizer.get_vocab()
    missing = [token for token in needed if token not in vocabulary]
    if missing:
        raise SystemExit(f"the tokenizer lacks {' '.join(missing)}")
    tokenizer.backend_tokenizer.no_truncation()
    tokenizer.backend_tokenizer.no_padding()
    tokenizer.backend_tokenizer.save(os.path.join(a.out, "tokenizer.json"))
    return tokenizer


class Differences:
    """The largest differences between graphs and original, by what was compared."""

    def __init__(self):
        self.found = {}

    def add(self, what, found, expected):
        expected = np.asarray(expected)
        if found.shape != expected.shape:
            raise SystemExit(f"{what}: the graph gives {found.shape}, the original {expected.shape}")
        finite = np.isfinite(expected)
        if not np.array_equal(finite, np.isfinite(found)):
            raise SystemExit(f"{what}: graph and original are not finite at the same places")
        scale = max(1.0, float(np.abs(expected[finite]).max()))
        worst = float(np.abs(found[finite] - expected[finite]).max()) / scale
        self.found[what] = max(self.found.get(what, 0.0), worst)

    def finish(self):
        """Prints them; ends the program if one is too large."""
        for what, worst in self.found.items():
            print(f"largest difference, {what}: {worst:.1e}")
        if max(self.found.values()) > LIMIT:
            raise SystemExit(f"more than {LIMIT} apart: do not use these graphs")
        print("verified")
