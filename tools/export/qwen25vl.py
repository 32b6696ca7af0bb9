"""Exports Qwen2.5-VL as the three graphs that `jrdb-perception` reads, and verifies them.

    python qwen25vl.py SOURCE OUT [--half]

Writes OUT/config.json, generation_config.json, preprocessor_config.json, tokenizer.json and OUT/onnx/{vision_encoder,embed_tokens,
decoder_model_merged}.onnx. The vision encoder takes pictures of any size, and several at once: what the original works out in loops over
the grid of patches - places, windows, which patches see each other - is computed in the graph.
"""
import torch

import causal
import common as C

NEEDED = ["<|im_start|>", "<|im_end|>", "<|vision_start|>", "<|image_pad|>", "<|vision_end|>"]
# Frames, rows and columns of patches: pictures within a window, of whole windows, of parts of windows; several; one of two frames.
GRIDS = [[[1, 4, 6]], [[1, 16, 8]], [[1, 10, 22]], [[1, 22, 10], [1, 4, 2], [1, 8, 12]], [[2, 6, 18], [1, 2, 2]]]


def places_of_patches(grid, count, merge):
    """For each patch: its picture, its frame among all, its row and its column. Patches of a token lie together, tokens row by row."""
    frames, rows, columns = grid.unbind(1)
    ends = torch.cumsum(frames * rows * columns, 0)
    patch = torch.arange(count)
    picture = (patch[:, None] >= ends[None, :]).sum(1)
    inside = patch - (ends - frames * rows * columns)[picture]
    area, across = (rows * columns)[picture], (columns // merge)[picture]
    frame, inside = inside // area, inside % area
    token, part = inside // (merge * merge), inside % (merge * merge)
    row, column = token // across * merge + part // merge, token % across * merge + part % merge
    earlier = torch.cumsum(frames, 0) - frames
    return picture, earlier[picture] + frame, row, column


def slots_of_patches(grid, places, side):
    """For each patch its slot among those of all windows of `side` by `side`, and the number of windows."""
    picture, frame, row, column = places
    frames, rows, columns = grid.unbind(1)
    down, across = (rows + side - 1) // side, (columns + side - 1) // side
    windows = frames * down * across
    earlier_frames = (torch.cumsum(frames, 0) - frames)[picture]
    first = (torch.cumsum(windows, 0) - windows)[picture] + (frame - earlier_frames) * (down * across)[picture]
    window = first + row // side * across[picture] + column // side
    return window * (side * side) + row % side * side + column % side, windows.sum()


def turned(values, cos, sin):
    """Rotary embedding of `[patches, heads, width]`."""
    half = values.shape[-1] // 2
    return values * cos + torch.cat([-values[..., half:], values[..., :half]], -1) * sin


def attention(query, key, value, hidden, scale):
    """`[groups, patches, heads, width]`; `hidden` is added to the scores, `[groups or 1, 1, patches or 1, patches]`."""
    query, key, value = (part.transpose(1, 2) for part in (query, key, value))
    shares = torch.softmax(query @ key.transpose(2, 3) * scale + hidden, -1)
    return (shares @ value).transpose(1, 2)


def minus_infinity_where(hidden):
    """As good as: what is added to hide scores."""
    return torch.where(hidden, torch.full((), torch.finfo(torch.float32).min), torch.zeros(()))


class Vision(torch.nn.Module):
    """The original's vision tower for any grid. Patches stay in their order; windows are gathered, looked at and put back."""

    def __init__(self, model):
        super().__init__()
        self.tower, config = model.model.visual, model.config.vision_config
        self.merge, self.whole = config.spatial_merge_size, set(config.fullatt_block_indexes)
        self.side = config.window_size // config.spatial_merge_size // config.patch_size * config.spatial_merge_size
        self.heads = config.num_heads

    def forward(self, pixel_values, image_grid_thw):
        count = pixel_values.shape[0]
        weight = self.tower.patch_embed.proj.weight
        state = pixel_values @ weight.reshape(weight.shape[0], -1).t()
        places = places_of_patches(image_grid_thw, count, self.merge)
        _, frame, row, column = places
        angles = torch.stack([row, column], 1)[:, :, None].float() * self.tower.rotary_pos_emb.inv_freq
        angles = angles.flatten(1).repeat(1, 2)[:, None, :]
        turn = angles.cos(), angles.sin()
        slot, windows = slots_of_patches(image_grid_thw, places, self.side)
        # Where each slot's patch is; empty slots point behind the last patch.
        source = torch.zeros(windows * self.side * self.side, dtype=torch.long) + count
        source = source.scatter(0, slot, torch.arange(count))
        in_window = minus_infinity_where((source == count).reshape(-1, 1, 1, self.side * self.side))
        in_frame = minus_infinity_where(frame[:, None] != frame[None, :])[None, None]
        for number, block in enumerate(self.tower.blocks):
            query, key, value = self.parts(block, state, turn)
            scale = block.attn.scaling
            if number in self.whole:
                seen = attention(query[None], key[None], value[None], in_frame, scale)[0]
            else:
                query, key, value = (self.gathered(part, source) for part in (query, key, value))
                seen = attention(query, key, value, in_window, scale).flatten(0, 1)[slot]
            state = state + block.attn.proj(seen.flatten(1))
            state = state + block.mlp(block.norm2(state))
        return self.tower.merger(state)

    def parts(self, block, state, turn):
        """Queries, keys and values, `[patches, heads, width]` each."""
        query, key, value = block.attn.qkv(block.norm1(state)).reshape(state.shape[0], 3, self.heads, -1).unbind(1)
        return turned(query, *turn), turned(key, *turn), value

    def gathered(self, part, source):
        """`[patches, heads, width]` to `[windows, slots, heads, width]`, zero in empty slots."""
        padded = torch.cat([part, torch.zeros_like(part[:1])])
        return padded[source].reshape(-1, self.side * self.side, part.shape[1], part.shape[2])


def load(a):
    from transformers import Qwen2_5_VLForConditionalGeneration

    model = C.load(Qwen2_5_VLForConditionalGeneration, a)
    causal.check(model.config.text_config)
    return model


def patch_width(model):
    vision = model.config.vision_config
    return vision.in_channels * vision.temporal_patch_size * vision.patch_size**2


def export(model, a):
    grid = torch.tensor([[1, 10, 6], [1, 4, 12]])
    pixels = torch.randn(int(grid.prod(1).sum()), patch_width(model))
    C.export(Vision(model), (pixels, grid), "vision_encoder", ["pixel_values", "image_grid_thw"], ["image_features"],
             {"pixel_values": {0: "num_patches"}, "image_grid_thw": {0: "num_images"}, "image_features": {0: "num_tokens"}}, a)
    causal.export(model, 3, a)


def write_files(model, a):
    """The files beside the graphs; the tokenizer."""
    tokenizer = C.write_tokenizer(a, NEEDED)
    if tokenizer.convert_tokens_to_ids("<|image_pad|>") != model.config.image_token_id:
        raise SystemExit("config.json names another image token than <|image_pad|>")
    C.write_config(a, model.config)
    C.write_json(a, "preprocessor_config.json", C.picture_config(a))
    causal.write_generation(model, tokenizer, a)
    return tokenizer


def prompt(question, grid, model):
    image = "<|image_pad|>" * (int(grid.prod()) // model.config.vision_config.spatial_merge_size**2)
    return (
        "<|im_start|>system\nYou are a helpful assistant.<|im_end|>\n<|im_start|>user\n"
        f"<|vision_start|>{image}<|vision_end|>{question}<|im_end|>\n<|im_start|>assistant\n"
    )


class Places:
    """Places in time, rows and columns: the original's own of a prompt, and counted on from there."""

    def __init__(self, model, grid):
        self.model, self.grid, self.further = model, grid, None

    def __call__(self, ids, mask):
        if ids.shape == mask.shape:
            places, self.further = self.model.model.get_rope_index(ids, image_grid_thw=self.grid, attention_mask=mask)
            return places
        return (mask.shape[1] - 1 + self.further)[None].repeat(3, 1, 1)


def seen(model, vision, grid, differences, what):
    """Random pictures and what the graph makes of them."""
    pixels = torch.randn(int(grid.prod(1).sum()), patch_width(model))
    features = vision.run(None, {"pixel_values": pixels.numpy(), "image_grid_thw": grid.numpy()})[0]
    differences.add(what, features, torch.cat(model.get_image_features(pixels, grid)))
    return {"pixel_values": pixels, "image_grid_thw": grid}, features


def verify(model, tokenizer, a):
    differences, vision = C.Differences(), C.session(a, "vision_encoder")
    graphs = causal.Graphs(model.config.text_config, a)
    for grid in GRIDS:
        seen(model, vision, torch.tensor(grid), differences, f"image features, grids {grid}")
    question = causal.QUESTIONS
    for asked in ([(question[0], [1, 10, 4])], [(question[1], [1, 6, 16])], [(question[1], [1, 10, 4]), (question[2], [1, 4, 22])]):
        grid = torch.tensor([sides for _, sides in asked])
        pictures, features = seen(model, vision, grid, differences, "image features of the questions")
        prompts = causal.batch(tokenizer, [prompt(text, sides, model) for (text, _), sides in zip(asked, grid)])
        causal.compare(model, graphs, prompts, pictures, features, Places(model, grid), differences)
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
