"""How far one linear picture is from another, away from the edges of direct light, and pictures of it."""
import numpy
import OpenImageIO

EDGE = 0.10          # a step in direct light between neighbouring pixels that counts as an edge, relative
EDGE_MARGIN = 3      # pixels around an edge that are left out
LEFT_OUT_MAX = 0.15  # share of the pixels that see something that may be


def read_channels(path):
    """name of the channel without its layer -> picture"""
    picture = OpenImageIO.ImageBuf(str(path))
    pixels = picture.get_pixels(OpenImageIO.FLOAT)
    if pixels is None or picture.has_error:
        raise ValueError(f"{path}: {picture.geterror()}")
    return {name.removeprefix("ViewLayer."): pixels[..., k] for k, name in enumerate(picture.spec().channelnames)}


def rgb(channels, prefix=""):
    return numpy.stack([channels[prefix + letter] for letter in "RGB"], axis=-1).astype(float)


class Reference:
    """A path tracer's picture, the mean of independent halves; their difference tells its noise."""

    def __init__(self, halves):
        halves = [read_channels(path) for path in halves]
        combined = [rgb(half, "Combined.") for half in halves]
        self.radiance = sum(combined) / len(halves)
        spread = sum((half - self.radiance) ** 2 for half in combined)
        self.variance = spread / (len(halves) * (len(halves) - 1))
        colour = rgb(halves[0], "DiffCol.")
        self.direct = colour * sum(rgb(half, "DiffDir.") for half in halves) / len(halves)
        self.direct += sum(rgb(half, "Emit.") for half in halves) / len(halves)
        self.emits = rgb(halves[0], "Emit.").max(axis=-1) > 0
        self.reflects = (colour.max(axis=-1) > 0) & ~self.emits


def steps_of(direct, floor):
    """How much a pixel's direct light differs from its neighbours', relative to the larger of both, of `floor` at least."""
    found = numpy.zeros(direct.shape[:2])
    for axis in (0, 1):
        one = numpy.take(direct, range(direct.shape[axis] - 1), axis)
        other = numpy.take(direct, range(1, direct.shape[axis]), axis)
        scale = numpy.maximum(numpy.maximum(one, other).max(axis=-1), floor)
        step = numpy.abs(one - other).max(axis=-1) / scale
        before, after = [slice(None)] * 2, [slice(None)] * 2
        before[axis], after[axis] = slice(None, -1), slice(1, None)
        for side in (tuple(before), tuple(after)):
            found[side] = numpy.maximum(found[side], step)
    return found


def near_edges(reference):
    """The pixels left out: near edges, and where these are too many near the strongest of them -> mask, weakest edge"""
    floor = 0.5 * reference.direct[reference.reflects].mean()
    steps, edge = steps_of(reference.direct, floor), EDGE
    while True:
        mask = grown(steps > edge, EDGE_MARGIN) & reference.reflects
        if mask.sum() <= LEFT_OUT_MAX * reference.reflects.sum():
            return mask, edge
        edge *= 1.02


def grown(mask, pixels):
    """The pixels within a distance of `pixels` of the mask."""
    out = numpy.zeros_like(mask)
    height, width = mask.shape
    for dy in range(-pixels, pixels + 1):
        for dx in range(-pixels, pixels + 1):
            if dx * dx + dy * dy <= pixels * pixels:
                y, x = slice(max(0, dy), height + min(0, dy)), slice(max(0, dx), width + min(0, dx))
                from_y, from_x = slice(max(0, -dy), height + min(0, -dy)), slice(max(0, -dx), width + min(0, -dx))
                out[y, x] |= mask[from_y, from_x]
    return out


class Comparison:
    """Root mean square difference over the mean of the reference, over pixels that see something that reflects.

    Pixels that see lamps are no part of it: they agree by construction, and their light would dwarf the mean.
    """

    def __init__(self, ours, reference):
        self.left_out, self.weakest_edge = near_edges(reference)
        kept = reference.reflects & ~self.left_out
        self.difference = ours - reference.radiance
        self.mean = reference.radiance[kept].mean()
        self.rmse = float(numpy.sqrt((self.difference[kept] ** 2).mean()) / self.mean)
        self.noise = float(numpy.sqrt(reference.variance[kept].mean()) / self.mean)
        self.bias = float(self.difference[kept].mean() / self.mean)
        self.left_out_share = float(self.left_out.sum() / reference.reflects.sum())
        every = reference.reflects
        self.rmse_with_edges = float(numpy.sqrt((self.difference[every] ** 2).mean())
                                     / reference.radiance[every].mean())


def shown(linear, white):
    """sRGB from linear light, `white` at 1."""
    x = numpy.clip(linear / white, 0, 1)
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def write_sheet(path, ours, reference, comparison):
    """Ours, theirs, and the difference: red where ours is brighter, blue where darker, full at 10 % of the mean; grey is left out."""
    white = 4 * comparison.mean
    relative = numpy.clip(comparison.difference.mean(axis=-1) / (0.1 * comparison.mean), -1, 1)
    signed = 1 - numpy.stack([numpy.maximum(0, -relative), numpy.abs(relative), numpy.maximum(0, relative)], axis=-1)
    signed[comparison.left_out | ~reference.reflects] *= 0.6
    sheet = numpy.concatenate([shown(ours, white), shown(reference.radiance, white), signed], axis=1).astype(numpy.float32)
    out = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(sheet.shape[1], sheet.shape[0], 3, OpenImageIO.UINT8))
    out.set_pixels(OpenImageIO.ROI(), numpy.ascontiguousarray(sheet))
    if not out.write(str(path)):
        raise OSError(out.geterror())
