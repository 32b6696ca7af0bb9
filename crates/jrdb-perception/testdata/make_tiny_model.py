"""Writes tiny.onnx: y = relu(a * x + b), and k + 1 in integers. Needs the Python package onnx."""
import pathlib

import onnx
from onnx import TensorProto, helper

FLOAT, INT = TensorProto.FLOAT, TensorProto.INT64
graph = helper.make_graph(
    [
        helper.make_node("Mul", ["x", "a"], ["ax"]),
        helper.make_node("Add", ["ax", "b"], ["ax_b"]),
        helper.make_node("Relu", ["ax_b"], ["y"]),
        helper.make_node("Add", ["k", "one"], ["k_next"]),
    ],
    "tiny",
    [helper.make_tensor_value_info("x", FLOAT, [1, 3]), helper.make_tensor_value_info("k", INT, [2])],
    [helper.make_tensor_value_info("y", FLOAT, [1, 3]), helper.make_tensor_value_info("k_next", INT, [2])],
    [
        helper.make_tensor("a", FLOAT, [1], [2.0]),
        helper.make_tensor("b", FLOAT, [1], [-1.0]),
        helper.make_tensor("one", INT, [1], [1]),
    ],
)
model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
onnx.checker.check_model(model)
onnx.save(model, pathlib.Path(__file__).with_name("tiny.onnx"))
