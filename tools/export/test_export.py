"""Builds a tiny checkpoint of each architecture with random weights, exports it, and lets `jrdb run` use what came out.

    python test_export.py [--keep DIR]

Random weights answer nonsense: it is looked at whether graphs equal the original and whether the program runs on them, with both of its
engines.
"""
import argparse
import glob
import json
import os
import subprocess
import sys
import tempfile

import torch

import causal
import grounding_dino
import internvl
import qwen25vl

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
TILE = 112
WORDS = "a an the person man woman find young elderly left right of to chair bag table white male adult".split()
NORMAL = {"image_mean": [0.485, 0.456, 0.406], "image_std": [0.229, 0.224, 0.225]}


def byte_tokenizer(special):
    """A byte-level vocabulary of Qwen's kind, trained on the questions."""
    from tokenizers import ByteLevelBPETokenizer
    from transformers import Qwen2TokenizerFast

    trained = ByteLevelBPETokenizer(add_prefix_space=False)
    trained.train_from_iterator(causal.QUESTIONS * 4, vocab_size=400, min_frequency=2, show_progress=False)
    with tempfile.TemporaryDirectory() as folder:
        vocabulary, merges = trained.save_model(folder)
        made = Qwen2TokenizerFast(vocab_file=vocabulary, merges_file=merges, eos_token="<|im_end|>", pad_token="<|endoftext|>")
    made.add_special_tokens({"additional_special_tokens": special})
    return made


def word_tokenizer():
    """A vocabulary of BERT's kind whose special tokens have the numbers that the model knows."""
    from transformers import BertTokenizerFast

    vocabulary = [f"[unused{number}]" for number in range(1030)]
    fixed = {0: "[PAD]", 100: "[UNK]", 101: "[CLS]", 102: "[SEP]", 103: "[MASK]", 1012: ".", 1029: "?"}
    letters = [chr(code) for code in range(ord("a"), ord("z") + 1)]
    free = (number for number in range(1, 1000) if number not in fixed)
    fixed |= {number: word for word, number in zip(dict.fromkeys(WORDS + letters + ["##" + letter for letter in letters]), free)}
    for number, word in fixed.items():
        vocabulary[number] = word
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "vocab.txt")
        with open(path, "w") as file:
            file.write("\n".join(vocabulary) + "\n")
        return BertTokenizerFast(vocab_file=path, do_lower_case=True, model_max_length=512)


def randomised(model):
    """Weights large enough that differences show."""
    with torch.no_grad():
        for name, weight in model.named_parameters():
            if weight.dim() > 1:
                weight.normal_(0, 1.2 / max(weight[0].numel(), 1) ** 0.5)
            elif "layer_scale" in name or "lambda" in name:
                weight.fill_(0.5)
    return model.eval()


def save(folder, *parts):
    for part in parts:
        part.save_pretrained(folder)


def tiny_internvl(folder):
    from transformers import GotOcr2ImageProcessorFast, InternVLConfig, InternVLForConditionalGeneration, InternVLVisionConfig, Qwen3Config

    tokenizer = byte_tokenizer(internvl.NEEDED)
    vision = InternVLVisionConfig(hidden_size=32, num_hidden_layers=2, num_attention_heads=2, intermediate_size=64, image_size=[TILE, TILE],
                                  patch_size=[14, 14], attention_bias=True)
    text = Qwen3Config(vocab_size=len(tokenizer), hidden_size=64, intermediate_size=128, num_hidden_layers=3, num_attention_heads=4,
                       num_key_value_heads=2, head_dim=32, rope_theta=1e6, eos_token_id=tokenizer.eos_token_id, tie_word_embeddings=True)
    config = InternVLConfig(vision_config=vision, text_config=text, image_token_id=tokenizer.convert_tokens_to_ids("<IMG_CONTEXT>"),
                            image_seq_length=(TILE // 28) ** 2, tie_word_embeddings=True)
    picture = GotOcr2ImageProcessorFast(size={"height": TILE, "width": TILE}, **NORMAL)
    save(folder, randomised(InternVLForConditionalGeneration(config)), tokenizer, picture)


def tiny_qwen25vl(folder):
    from transformers import Qwen2_5_VLConfig, Qwen2_5_VLForConditionalGeneration, Qwen2VLImageProcessor

    tokenizer = byte_tokenizer(qwen25vl.NEEDED)
    ids = {name: tokenizer.convert_tokens_to_ids(f"<|{token}|>")
           for name, token in (("image_token_id", "image_pad"), ("vision_start_token_id", "vision_start"), ("vision_end_token_id", "vision_end"))}
    text = dict(vocab_size=len(tokenizer), hidden_size=64, intermediate_size=128, num_hidden_layers=3, num_attention_heads=4, num_key_value_heads=2,
                rope_theta=1e6, eos_token_id=tokenizer.eos_token_id, rope_scaling={"type": "mrope", "mrope_section": [2, 3, 3]})
    vision = dict(depth=3, hidden_size=32, num_heads=2, intermediate_size=64, out_hidden_size=64, window_size=112, fullatt_block_indexes=[1])
    config = Qwen2_5_VLConfig(text_config=text, vision_config=vision, video_token_id=len(tokenizer) + 1, **ids)
    save(folder, randomised(Qwen2_5_VLForConditionalGeneration(config)), tokenizer, Qwen2VLImageProcessor(min_pixels=3136, max_pixels=200704))


def tiny_grounding_dino(folder):
    from transformers import BertConfig, GroundingDinoImageProcessor, MMGroundingDinoConfig, MMGroundingDinoForObjectDetection, SwinConfig

    tokenizer = word_tokenizer()
    swin = SwinConfig(embed_dim=16, depths=[2, 2, 2, 2], num_heads=[1, 2, 2, 4], window_size=7, out_indices=[2, 3, 4])
    bert = BertConfig(vocab_size=len(tokenizer), hidden_size=32, num_hidden_layers=1, num_attention_heads=2, intermediate_size=64)
    config = MMGroundingDinoConfig(backbone_config=swin, text_config=bert.to_dict(), num_queries=30, d_model=32, encoder_layers=1, decoder_layers=2,
                                   encoder_ffn_dim=64, decoder_ffn_dim=64, encoder_attention_heads=2, decoder_attention_heads=2)
    picture = GroundingDinoImageProcessor(size={"shortest_edge": 160, "longest_edge": 266}, **NORMAL)
    save(folder, randomised(MMGroundingDinoForObjectDetection(config)), tokenizer, picture)


def export(script, source, out, *more):
    """Runs an exporter as a user would; what it prints."""
    command = [sys.executable, os.path.join(HERE, script + ".py"), source, out, *more]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"{script}: {done.stdout}{done.stderr}"
    assert "verified" in done.stdout, done.stdout
    print(f"--- {script} {' '.join(more)}\n{done.stdout}", flush=True)
    return done.stdout


def backbone(models, name, detector, kind, folder):
    """A backbone file; takes every box, so that random weights find people to describe."""
    sure = {"threshold": 0.0, "text_threshold": 0.0}
    value = {
        "about": "random weights",
        "detector": {"grounding_dino": {"graphs": {"folder": detector}, "settings": {"phrases": ["person", "chair"], "grounding": sure}}},
        "attributes": {kind: {"graphs": {"folder": folder}}},
    }
    with open(os.path.join(models, name + ".json"), "w") as file:
        json.dump(value, file)


def run(models, name, *engine):
    """`jrdb run` on a drawn scene: random weights find people and say something of them."""
    command = ["cargo", "run", "-q", "-p", "jrdb", "--bin", "jrdb", "--", "run", "--scene", "testdata/scenes/plaza",
               "--perception", name, "--models", models, "--profile", *engine]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, f"{name}: {done.stdout}{done.stderr}"
    said = (done.stdout + done.stderr).splitlines()
    shown = [line for line in said if line.startswith("engine:") or "decoder_model_merged" in line or "model  " in line]
    assert any("decoder_model_merged" in line for line in shown), "nobody was described"
    print(f"--- jrdb run, {name}", *shown, sep="\n", flush=True)


def engines():
    """Options of both engines; ONNX Runtime is the library of this Python's package."""
    import onnxruntime

    libraries = glob.glob(os.path.join(os.path.dirname(onnxruntime.__file__), "capi", "libonnxruntime.so.*"))
    return [("--engine", "rten")] + [("--engine", "ort", "--onnxruntime", library) for library in libraries]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--keep", metavar="DIR", help="leave checkpoints and graphs there")
    kept = parser.parse_args().keep
    torch.manual_seed(0)
    with tempfile.TemporaryDirectory() as temporary:
        test(os.path.abspath(kept) if kept else temporary)


def test(folder):
    models = os.path.join(folder, "models")
    tiny = {"internvl": tiny_internvl, "qwen25vl": tiny_qwen25vl, "grounding_dino": tiny_grounding_dino}
    for script, build in tiny.items():
        source = os.path.join(folder, "source", script)
        build(source)
        export(script, source, os.path.join(models, script))
        told = export(script, source, os.path.join(models, script + "-half"), "--half", "--split-above", "0.1")
        assert "beside it" in told, told
    oblong = ("--canvas", "224", "160")
    export("grounding_dino", os.path.join(folder, "source", "grounding_dino"), os.path.join(models, "oblong"), *oblong)
    backbone(models, "one", "grounding_dino", "internvl", "internvl")
    backbone(models, "two", "oblong", "qwen2.5-vl", "qwen25vl-half")
    for name in ("one", "two"):
        for engine in engines():
            run(models, name, *engine)


if __name__ == "__main__":
    main()
