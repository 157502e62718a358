"""What a picture file says that a stream does not keep (docs/pictures.md, "What is kept besides pixels")."""

from __future__ import annotations

import re
import struct

from sgicodec.errors import PictureError
from sgicodec.metadata import (
    avif,
    exif,
    extended_xmp,
    ifd,
    jp2,
    jpeg,
    jxl,
    pages,
    photoshop,
    png,
    radiance,
    stacks,
    stated_colours,
    tiff,
    webp,
)
from sgicodec.metadata.filebytes import Bytes

_INKS, _TEXTS, _COLOURS = "inks (RGB instead)", "texts", "colour space"
_PACKED = "EXIF or XMP that Brotli compressed (the extra avif reads it)"
_SRGB, _UNKNOWN = (1, 13), 2
"""Colour primaries and transfer function by their numbers (ITU-T H.273), and the number of either that says nothing."""
_SRGB_GAMMA = 45455
_SRGB_PLACES = tuple(round(100_000 * place) for place in (*stated_colours.WHITE, *stated_colours.PRIMARIES))
_NEAR = 100
"""In 100,000ths, of what PNG states of sRGB."""
_OF_COLOURS = (b"cICP", b"iCCP", b"sRGB", b"gAMA", b"cHRM")
_KEPT_TEXTS = (b"XML:com.adobe.xmp", b"Raw profile type exif", b"Raw profile type APP1", b"Raw profile type xmp")
_IDLE_TEXTS = (b"Software", b"date:", b"Creation Time", b"Raw profile type icc")
"""Beginnings of keywords that say nothing of the picture itself."""
_IDLE_COMMENTS = (b"File written by", b"Created with", b"CREATOR:", b"LEAD Technologies", b"Lavc", b"Compressed by")
"""Beginnings of comments that name a program alone."""
_PHOTOSHOP, _MORE_PICTURES = b"Photoshop 3.0\0", b"MPF\0"
_APP1, _APP2, _APP11, _APP13, _COMMENT = 0xE1, 0xE2, 0xEB, 0xED, 0xFE
_APPLICATIONS = range(0xE0, 0xF0)
_IDLE_SEGMENTS = (b"JFIF", b"JFXX", b"AVI1", b"SPIFF", b"Exif\0", b"ICC_PROFILE\0", b"Ducky", b"Adobe")
"""Beginnings of those that are kept, or say nothing of the picture itself."""
_BEHIND = ("a video (motion photo)", "further pictures (MPF)")
"""What stands behind the end of a JPEG, where that says so."""
_MAX_PADDING = 1 << 16
_CREDENTIALS, _JUMBF = "Content Credentials", b"JP"
_PNG_CHUNKS = (
    *(b"IHDR", b"PLTE", b"IDAT", b"tRNS", b"pHYs", b"eXIf", b"acTL", b"fcTL", b"fdAT"),
    *(b"tIME", b"bKGD", b"hIST", b"iDOT", b"vpAg"),
)
_NUMBER = rb"(?:\s|#[^\n]*\n)+(\d+)"
_PNM, _MAX_PNM_HEADER = re.compile(rb"(?:P4" + 2 * _NUMBER + rb"|P([56])" + 3 * _NUMBER + rb")\s"), 1 << 12
"""The header of a Netpbm file of bits, or of bytes: width, height and, of bytes, the largest sample."""
_WEBP_CHUNKS = (b"VP8X", b"VP8 ", b"VP8L", b"ALPH", b"ANIM", b"ANMF", b"ICCP", b"EXIF", b"XMP ")
"""Chunks that are read, or say nothing of the picture itself."""
_MOTION = (b'MotionPhoto="1"', b'MicroVideo="1"')
_FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}
_PHOTOMETRIC, _COLOUR_TABLE, _TIFF_IPTC, _TIFF_PHOTOSHOP, _TIFF_LAYERS = 262, 320, 33723, 34377, 37724
_SHORT, _PALETTE, _SEPARATED = 3, 3, 5
_NAMED = {_TIFF_LAYERS: "layers", 50909: "GEO_METADATA", 50839: "ImageJ's LUTs, overlays or labels"}
_NAMED |= {285: "PageName", 291: "GrayResponseCurve", 340: "SMinSampleValue", 341: "SMaxSampleValue"}
_BITS, _LOW, _HIGH = 258, 280, 281
_PAGE_X, _PAGE_Y, _INK_SET, _CMYK = 286, 287, 332, 1
_ASKED = {
    _PHOTOMETRIC,
    _COLOUR_TABLE,
    _TIFF_IPTC,
    _TIFF_PHOTOSHOP,
    *_NAMED,
    _BITS,
    _LOW,
    _HIGH,
    _PAGE_X,
    _PAGE_Y,
    _INK_SET,
}
_FIRST_PRIVATE = 32768
_IDLE_PRIVATE = {*range(32995, 32999), 33421, 33422, 37398, 50341, 50674, 59932, 59933}
"""How samples become a photograph (TIFF/EP); what printers and Windows leave; bytes of ImageJ's."""


def left_behind(data: Bytes) -> list[str]:
    """Names of it, of the bytes of any picture file; of damaged ones as far as they can be read."""
    try:
        if data[:8] == png.SIGNATURE:
            found = _of_png(data)
        elif data[:3] == jpeg.SIGNATURE:
            found = _of_jpeg(data)
        elif webp.is_webp(data):
            found = [_of_chunk(kind) for kind, _, _ in webp.chunks(data) if kind not in _WEBP_CHUNKS]
        elif avif.is_avif(data):
            still = avif.still(data)
            found = [f"{_COLOURS} (nclx)"] if still.colours and are_foreign(still.colours) else []
            found += ["further pictures (a gain map, depth)"] * still.has_more
        elif jxl.is_boxed(data):
            found = [_PACKED] if jxl.has_unread(data) else []
        elif jp2.is_boxed(data):
            found = jp2.left_behind(data)
        elif photoshop.is_psd(data):
            found = photoshop.left_behind(data)
        elif radiance.is_radiance(data):
            found = radiance.left_behind(data)
        elif data[:2] == b"BM":
            found = stated_colours.of_bmp(data)
        elif stated := _PNM.match(bytes(data[:_MAX_PNM_HEADER])):
            found = _behind(data, _end_of_pnm(stated))
        elif data[:4] == b"qoif":
            found = stated_colours.of_qoi(data)
        else:
            found = _of_tiff(data)
    except (struct.error, PictureError):
        return []
    return list(dict.fromkeys(found))


def _of_png(data: Bytes) -> list[str]:
    stated: dict[bytes, bytes] = {}
    texts = []
    for kind, start, end in png.chunks(data):
        if kind in _OF_COLOURS:
            stated[kind] = bytes(data[start : min(end, start + 32)])
        elif kind == b"IEND":
            texts += _behind(data, end + 4)
            break
        elif kind not in (b"tEXt", b"zTXt", b"iTXt", *_PNG_CHUNKS):
            is_idle = kind == b"oFFs" and not any(data[start : start + 8])  # as OpenImageIO writes it
            texts += [] if is_idle else [_of_chunk(kind)]
        elif kind not in _PNG_CHUNKS:
            keyword = bytes(data[start : min(end, start + 79)])
            if not keyword.startswith(_KEPT_TEXTS + _IDLE_TEXTS):
                texts.append(photoshop.IPTC if keyword.startswith(b"Raw profile type iptc") else _TEXTS)
    if b"cICP" in stated:
        is_foreign = are_foreign(tuple(stated[b"cICP"][:2])) or stated[b"cICP"][3:4] == b"\0"  # of few levels
        return [f"{_COLOURS} (cICP)", *texts] if is_foreign else texts
    if stated.keys() & {b"iCCP", b"sRGB"}:
        return texts
    is_far = _is_far(stated.get(b"gAMA"), (_SRGB_GAMMA,)) or _is_far(stated.get(b"cHRM"), _SRGB_PLACES)
    return [f"{_COLOURS} (gAMA, cHRM)", *texts] if is_far else texts


def _of_chunk(kind: bytes) -> str:
    return _CREDENTIALS if kind in (b"caBX", b"C2PA") else f"chunk {kind.decode('latin-1').strip()}"


def _behind(data: Bytes, at: int) -> list[str]:
    """Bytes behind the end of the picture, but for padding."""
    more = len(data) - at
    is_padding = more < _MAX_PADDING and not bytes(data[at:]).strip(b"\0\xff\r\n ")
    return [] if more <= 0 or is_padding else [f"{more:,} bytes behind its end"]


def are_foreign(colours: tuple[int, ...]) -> bool:
    """Whether primaries or transfer function, by their numbers, are not those of sRGB."""
    return any(stated not in (usual, _UNKNOWN) for stated, usual in zip(colours, _SRGB, strict=False))


def _end_of_pnm(header: re.Match[bytes]) -> int:
    """Place behind the first picture of a Netpbm file in bytes; others may follow."""
    if header[3] is None:
        width, height = map(int, header.group(1, 2))
        return header.end() + (width + 7) // 8 * height
    width, height, largest = map(int, header.group(4, 5, 6))
    return header.end() + width * height * (3 if header[3] == b"6" else 1) * (2 if largest > 255 else 1)


def _is_far(contents: bytes | None, usual: tuple[int, ...]) -> bool:
    """Whether whole numbers of 32 bits are others than these."""
    if contents is None:
        return False
    stated = struct.unpack(f">{len(usual)}I", contents)
    return any(abs(a - b) > _NEAR for a, b in zip(stated, usual, strict=True))


def _of_jpeg(data: Bytes) -> list[str]:
    found, packet, has_exif = [], b"", False
    pieces, resources, jumbf = [], [], []
    for start, end in jpeg.segments(data):
        marker, payload = data[start + 1], bytes(data[start + 4 : end])
        if marker == _APP13 and payload.startswith(_PHOTOSHOP):
            resources.append(payload.removeprefix(_PHOTOSHOP))
        elif marker == _APP1 and payload.startswith(jpeg.EXTENSION_PREFIX):
            pieces.append(payload.removeprefix(jpeg.EXTENSION_PREFIX))
        elif marker == _APP1 and payload.startswith(exif.PREFIX) and ifd.layout(payload[len(exif.PREFIX) :]):
            found += ["a second EXIF"] if has_exif else []
            has_exif = True
        elif marker == _APP1 and payload.startswith(jpeg.XMP_PREFIX):
            found += ["a second XMP packet"] if packet else []
            packet = packet or payload
            found += [_BEHIND[0]] if any(word in payload for word in _MOTION) else []
        elif marker == _APP2 and payload.startswith(_MORE_PICTURES):
            found.append(_BEHIND[1])
        elif marker == _APP11 and payload.startswith(_JUMBF):
            jumbf.append(payload)
        elif marker in _APPLICATIONS and not payload.startswith(_IDLE_SEGMENTS):
            found.append(_of_segment(marker, payload))
        elif marker == _COMMENT and not payload.startswith(_IDLE_COMMENTS):
            found.append("a comment")
        elif marker in _FRAMES and payload[5:6] == b"\4":
            found.append(_INKS)
    found += [_CREDENTIALS if any(b"c2pa" in payload for payload in jumbf) else "APP11 (JUMBF)"] if jumbf else []
    found += photoshop.names(b"".join(resources))
    found += ["a part of its XMP"] if extended_xmp.is_lost(packet, pieces) else []
    return found if set(found) & set(_BEHIND) else found + _behind(data, jpeg.end(data))


def _of_segment(marker: int, payload: bytes) -> str:
    """An application's, by its number and the name that it begins with."""
    name = payload.partition(b"\0")[0][:12].decode("latin-1")
    number = f"APP{marker - _APPLICATIONS[0]}"
    return f"{number} ({name})" if name.isprintable() and name else number


def _of_tiff(data: Bytes) -> list[str]:
    entries = ifd.entries(data, _ASKED | stated_colours.TIFF_TAGS)
    stated, resources = entries.get(_PHOTOMETRIC), entries.get(_TIFF_PHOTOSHOP)
    photometric = None if stated is None else stated.short
    is_cmyk = _INK_SET not in entries or entries[_INK_SET].short == _CMYK
    found = [_INKS if is_cmyk else "names of inks"] if photometric == _SEPARATED else []
    if photometric == _PALETTE:
        found.append(_palette(entries.get(_COLOUR_TABLE)))
    elif _COLOUR_TABLE in entries:
        found.append("its colour table")
    if _TIFF_IPTC in entries:
        found.append(photoshop.IPTC)
    found += photoshop.names(resources.data) if resources is not None else []
    found += stated_colours.of_tiff(entries) + [name for tag, name in _NAMED.items() if tag in entries]
    bits = entries[_BITS].short if _BITS in entries else 1
    for tag, name, usual in ((_LOW, "MinSampleValue", 0), (_HIGH, "MaxSampleValue", (1 << min(bits, 16)) - 1)):
        found += [name] * (tag in entries and entries[tag].short != usual)
    found += ["a mask"] * pages.has_mask(data) + pages.associated_images(data)
    if any(entries[tag].data[:4].strip(b"\0") for tag in (_PAGE_X, _PAGE_Y) if tag in entries):
        found.append("its position on a page")
    found += stacks.left_behind(tiff.of_stack(data) | ifd.load(data, {tiff.DESCRIPTION}))
    known = _ASKED | tiff.KEPT | tiff.STRUCTURE | stated_colours.TIFF_TAGS | _IDLE_PRIVATE
    unknown = [tag for tag in ifd.tags(data) if tag not in known]
    private = sum(tag >= _FIRST_PRIVATE for tag in unknown)
    for count, kind in ((len(unknown) - private, "other"), (private, "private")):
        found += [f"{count} {kind} tag{'s' * (count > 1)}"] * (count > 0)
    return found


def _palette(table: ifd.Entry | None) -> str:
    """What becomes of the classes that samples of a palette are. table: its colours, of 16 bits."""
    stated = table.data if table is not None and table.kind == _SHORT else b""
    levels = [level for (level,) in struct.iter_unpack("<H", stated)]
    is_rounded = max(levels, default=0) >= 256 and any(level % 257 for level in levels)
    return f"palette (RGB{' of 8 bits, rounded down,' if is_rounded else ''} instead)"
