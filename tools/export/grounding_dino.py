"""Exports MM-Grounding-DINO and LLMDet as the graph that `jrdb-perception` reads, and verifies it.

    python grounding_dino.py SOURCE OUT [--canvas W H] [--half]

Writes OUT/config.json, preprocessor_config.json, tokenizer.json and OUT/onnx/model.onnx. The backbone decides on its padding in Python, so a
graph is good for pictures of one size: every picture is put on a canvas, whose size is written into preprocessor_config.json as `pad_size`.
Prompts may have any number of phrases: the original finds them in a loop that a trace would freeze, the graph does without.
"""
import os
from unittest import mock

import onnx
import torch

import common as C

NEEDED = ["[CLS]", "[SEP]", ".", "?"]
# What phrases lie between: [CLS], [SEP], "." and "?". The original has the same numbers.
SPECIAL = (101, 102, 1012, 1029)
INPUTS = ["pixel_values", "input_ids", "token_type_ids", "attention_mask", "pixel_mask"]
PROMPTS = [
    "person.", "a person. a chair. a bag.", "find the young man to the left of the elderly woman.", "male person . white adult ? table .",
    "a person",
]


def phrase_mask(input_ids):
    """Which tokens see each other, and their places within their phrase, for `[batch, length]`, as the original has them.

    A token sees its phrase, whose end is a special token and belongs to it. The first and the last column, padding behind the last special
    token, and the tokens that the last column would close see only themselves.
    """
    rows, length = input_ids.shape
    special = sum((input_ids == token).long() for token in SPECIAL)
    column = torch.arange(length)
    earlier = torch.cumsum(special, 1) - special  # specials before a token: the number of its phrase
    later = torch.flip(torch.cumsum(torch.flip(special, [1]), 1), [1])  # specials at or behind it
    is_edge = ((column == 0) | (column == length - 1))[None] & (special > 0)
    is_tail = (earlier == earlier[:, -1:]) & (special[:, -1:] > 0)
    alone = is_edge | (later == 0) | is_tail
    same = (earlier[:, :, None] == earlier[:, None, :]) & ~alone[:, :, None] & ~alone[:, None, :]
    before = (special[:, None, :] > 0) & (column[None, :, None] > column[None, None, :])
    start = torch.where(before, column[None, None, :].expand(rows, length, length), 0).amax(-1)
    place = torch.where(alone, 0, column[None, :] - start - 1)
    return same | (column[:, None] == column[None, :])[None], place


class Whole(torch.nn.Module):
    """Pictures on canvases and a prompt to the scores of each query's tokens and boxes."""

    def __init__(self, model):
        super().__init__()
        self.model = model

    def forward(self, *inputs):
        found = self.model(**dict(zip(INPUTS, inputs)))
        return found.logits, found.pred_boxes


def arguments():
    parser = C.parser(__doc__)
    parser.add_argument("--canvas", nargs=2, type=int, metavar=("W", "H"), help="default: a square of the processor's longest edge")
    return parser.parse_args()


def load(a):
    from transformers import MMGroundingDinoForObjectDetection

    return C.load(MMGroundingDinoForObjectDetection, a)


def write_files(model, a):
    """The files beside the graph; the tokenizer and the canvas, rows and columns."""
    tokenizer = C.write_tokenizer(a, NEEDED)
    found = tuple(tokenizer.convert_tokens_to_ids(token) for token in NEEDED)
    if found != SPECIAL:
        raise SystemExit(f"expected {NEEDED} to be {SPECIAL}, as the model has them; the tokenizer has {found}")
    picture = C.picture_config(a)
    longest = picture["size"]["longest_edge"]
    width, height = a.canvas or (longest, longest)
    picture["pad_size"] = {"height": height, "width": width}
    C.write_config(a, model.config)
    C.write_json(a, "preprocessor_config.json", picture)
    return tokenizer, (height, width)


def pictures(canvas):
    """Two random pictures: one as large as the canvas, one in its upper left corner."""
    height, width = canvas
    pixels, mask = torch.randn(2, 3, height, width), torch.ones(2, height, width, dtype=torch.long)
    mask[1, height // 2:], mask[1, :, 3 * width // 4:] = 0, 0
    return pixels * mask[:, None], mask


def spelled(tokenizer, prompt, rows):
    """A prompt for each of so many pictures."""
    ids = torch.tensor([tokenizer(prompt)["input_ids"]]).repeat(rows, 1)
    return {"input_ids": ids, "token_type_ids": torch.zeros_like(ids), "attention_mask": torch.ones_like(ids)}


def asked(tokenizer, canvas):
    """Prompts about each picture, and about both at once."""
    pixels, mask = pictures(canvas)
    for prompt, rows in [(prompt, [row]) for prompt in PROMPTS for row in (0, 1)] + [(PROMPTS[1], [0, 1])]:
        yield {"pixel_values": pixels[rows], "pixel_mask": mask[rows], **spelled(tokenizer, prompt, len(rows))}


def export(model, tokenizer, canvas, a):
    pixels, mask = pictures(canvas)
    example = {"pixel_values": pixels, "pixel_mask": mask, **spelled(tokenizer, PROMPTS[1], 2)}
    axes = {name: {0: "batch_size"} for name in ("pixel_values", "pixel_mask", "logits", "pred_boxes")}
    axes |= {name: {0: "batch_size", 1: "sequence_length"} for name in ("input_ids", "token_type_ids", "attention_mask")}
    C.export(Whole(model), tuple(example[name] for name in INPUTS), "model", INPUTS, ["logits", "pred_boxes"], axes, a)


def check_mask(original, tokenizer):
    for prompt in PROMPTS:
        ids = spelled(tokenizer, prompt, 1)["input_ids"]
        pairs = zip(original(ids), phrase_mask(ids))
        if not all(torch.equal(one, other) for one, other in pairs):
            raise SystemExit(f"the mask of {prompt!r} is not the original's")


def graph_that_tells(a):
    """The exported graph with one more output: which places of the pictures became queries."""
    folder = os.path.join(a.out, "onnx")
    model = onnx.load(os.path.join(folder, "model.onnx"), load_external_data=False)
    (top,) = [node for node in model.graph.node if node.op_type == "TopK"]
    model.graph.output.append(onnx.helper.make_tensor_value_info(top.output[1], onnx.TensorProto.INT64, None))
    # Beside the original, where weights of its own file are found.
    path = os.path.join(folder, "model_that_tells.onnx")
    onnx.save_model(model, path)
    try:
        return C.session(a, "model_that_tells"), ["logits", "pred_boxes", top.output[1]]
    finally:
        os.remove(path)


def choosing(choice, differences):
    """`torch.topk` that takes the graph's choice, if that is as good as its own.

    Hundreds of queries are taken in the order of their scores, some of which are equal but for rounding; exchanged, they are other queries.
    """
    own = torch.topk

    def choose(scores, count, dim):
        best, picked = own(scores, count, dim=dim)[0], scores.gather(dim, choice)
        differences.add("scores of the chosen queries", picked.numpy(), best.numpy())
        return picked, choice

    return mock.patch.object(torch, "topk", choose)


def verify(model, tokenizer, canvas, a):
    differences, (graph, outputs) = C.Differences(), graph_that_tells(a)
    names = [given.name for given in graph.get_inputs()]
    for inputs in asked(tokenizer, canvas):
        logits, boxes, choice = graph.run(outputs, {name: inputs[name].numpy() for name in names})
        with choosing(torch.from_numpy(choice), differences):
            expected = model(**inputs)
        rows = "1 picture" if len(logits) == 1 else f"{len(logits)} pictures"
        differences.add(f"logits, {rows}", logits, expected.logits)
        differences.add(f"boxes, {rows}", boxes, expected.pred_boxes)
    differences.finish()


def main():
    import transformers.models.mm_grounding_dino.modeling_mm_grounding_dino as original

    a = arguments()
    C.prepare(a)
    model = load(a)
    tokenizer, canvas = write_files(model, a)
    check_mask(original.generate_masks_with_special_tokens_and_transfer_map, tokenizer)
    with mock.patch.object(original, "generate_masks_with_special_tokens_and_transfer_map", phrase_mask):
        export(model, tokenizer, canvas, a)
    verify(model, tokenizer, canvas, a)


if __name__ == "__main__":
    main()
