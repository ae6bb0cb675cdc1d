"""Reads the frames of animated GIF and of WebM, as far as tests of exported animations need them."""


def gif_frames(data):
    """Size of a GIF, and of every frame its delay in hundredths of a second and its decoded pixels."""
    assert data[:6] == b"GIF89a" and data[-1] == 0x3B
    width, height = int.from_bytes(data[6:8], "little"), int.from_bytes(data[8:10], "little")
    at, delay, frames = 13 + 3 * (2 << (data[10] & 7)), 0, []
    while data[at] != 0x3B:
        if data[at] == 0x21:  # an extension, with the delay or with how often it is repeated
            if data[at + 1] == 0xF9:
                delay = int.from_bytes(data[at + 4:at + 6], "little")
            _, at = blocks(data, at + 2)
            continue
        assert data[at] == 0x2C
        left, top, wide, tall = (int.from_bytes(data[at + k:at + k + 2], "little") for k in (1, 3, 5, 7))
        assert left + wide <= width and top + tall <= height
        smallest = data[at + 10]
        code, at = blocks(data, at + 11)
        pixels = unpacked(code, smallest)
        assert len(pixels) == wide * tall, (len(pixels), wide, tall)
        frames.append((delay, (left, top, wide, tall), pixels))
    return (width, height), frames


def blocks(data, at):
    """Contents of blocks that are each preceded by their length, and where they end."""
    parts = []
    while data[at] != 0:
        parts.append(data[at + 1:at + 1 + data[at]])
        at += 1 + data[at]
    return b"".join(parts), at + 1


def unpacked(code, smallest):
    """What the codes of Lempel, Ziv and Welch stand for."""
    clear = 1 << smallest
    table, bits, before, result = [], smallest + 1, b"", []
    held = count = 0
    for byte in code:
        held, count = held | byte << count, count + 8
        while count >= bits:
            value, held, count = held & ((1 << bits) - 1), held >> bits, count - bits
            if value == clear:
                table, bits, before = [bytes([k]) for k in range(clear)] + [b"", b""], smallest + 1, b""
                continue
            if value == clear + 1:
                return b"".join(result)
            entry = table[value] if value < len(table) else before + before[:1]
            result.append(entry)
            if before and len(table) < 4096:
                table.append(before + entry[:1])
            before = entry
            if len(table) == 1 << bits and bits < 12:
                bits += 1
    raise AssertionError("the end is missing")


def webm_times(data):
    """Times in milliseconds of the frames of a video in WebM."""
    masters = {0x18538067, 0x1F43B675, 0xA0}  # segment, cluster, group of blocks
    times, cluster = [], 0

    def number(at, with_mark):
        length = 9 - data[at].bit_length()
        value = int.from_bytes(data[at:at + length], "big")
        unknown = value == (1 << 7 * length + 1) - 1
        return (value if with_mark else None if unknown else value & ((1 << 7 * length) - 1)), at + length

    assert data[:4] == b"\x1a\x45\xdf\xa3"
    at = 0
    while at < len(data):
        name, at = number(at, True)
        size, at = number(at, False)
        if name in masters:
            continue
        if name == 0xE7:  # time of the cluster
            cluster = int.from_bytes(data[at:at + size], "big")
        elif name in (0xA3, 0xA1):  # a frame, with its time after the number of the track
            times.append(cluster + int.from_bytes(data[at + 1:at + 3], "big", signed=True))
        at += size
    return times
