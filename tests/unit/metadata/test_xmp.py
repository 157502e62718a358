from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgicodec.metadata import xmp
from sgicodec.metadata.motion import Motion

TWICE = Motion(64, 48, 1, 0, 0, 2, 2, 128, 96)
PART = Motion(64, 48, 1, 8, 4, 1, 1, 16, 20)
TURNED = Motion(64, 48, 6)


def packet(attributes: str, elements: str = "") -> bytes:
    schemas = {
        "tiff": "http://ns.adobe.com/tiff/1.0/",
        "exif": "http://ns.adobe.com/exif/1.0/",
        "GPano": "http://ns.google.com/photos/1.0/panorama/",
        "mwg-rs": "http://www.metadataworkinggroup.com/schemas/regions/",
        "stDim": "http://ns.adobe.com/xap/1.0/sType/Dimensions#",
        "t": "http://ns.adobe.com/tiff/1.0/",
    }
    names = "".join(f" xmlns:{name}='{address}'" for name, address in schemas.items())
    return f"<rdf:Description{names} note:a='PixelXDimension 64'{attributes}>{elements}</rdf:Description>".encode()


def test_the_orientation() -> None:
    assert xmp.orientation(b'<a tiff:Orientation="6" b="5">') == 6
    assert xmp.orientation(b"<tiff:Orientation>8</tiff:Orientation>") == 8
    assert xmp.orientation(b'<a tiff:Orientation="9" Orientation="3">') is None
    assert xmp.orientation(packet(" t:Orientation = '3'")) == 3
    assert xmp.orientation(None) is None
    assert xmp.upright(b'<a tiff:Orientation="6" b="6">') == b'<a tiff:Orientation="1" b="6">'
    assert xmp.upright(b"<tiff:Orientation>8</tiff:Orientation>") == b"<tiff:Orientation>1</tiff:Orientation>"


def test_what_points_behind_the_picture_is_taken_out() -> None:
    before = (
        b'<rdf:Description xmlns:C="http://ns.google.com/photos/1.0/container/" dc:source="me"'
        b' xmlns:hdrgm="http://ns.adobe.com/hdr-gain-map/1.0/" hdrgm:Version="1.0"'
        b' GCamera:MotionPhoto="1" GCamera:MicroVideoOffset="1234"><C:Directory><rdf:Seq><rdf:li>'
        b'<C:Item Item:Semantic="GainMap"/></rdf:li></rdf:Seq></C:Directory><dc:title>x</dc:title></rdf:Description>'
    )
    after = xmp.upright(before)
    assert after.endswith(b"><dc:title>x</dc:title></rdf:Description>")
    assert b'dc:source="me"' in after
    assert not any(word in after for word in (b"Version", b"Motion", b"Micro", b"Directory", b"Item"))
    assert xmp.upright(after) == after


@pytest.mark.parametrize(
    ("before", "motion", "after"),
    [
        (" tiff:ImageWidth='64' tiff:ImageLength='48'", TURNED, " tiff:ImageWidth='48' tiff:ImageLength='64'"),
        (" exif:PixelXDimension='64'", TURNED, " exif:PixelXDimension='48'"),
        (' exif:PixelXDimension = "64"', TWICE, ' exif:PixelXDimension = "128"'),
        (" t:ImageWidth='64' t:ImageLength='48'", PART, " t:ImageWidth='16' t:ImageLength='20'"),
        (
            " tiff:XResolution='300/1' tiff:YResolution='150'",
            TURNED,
            " tiff:XResolution='150/1' tiff:YResolution='300/1'",
        ),
        (" tiff:XResolution='300/1' tiff:YResolution='7/2'", TWICE, " tiff:XResolution='600/1' tiff:YResolution='7/1'"),
        (" tiff:XResolution='300/1'", TURNED, " "),
        (" exif:FocalPlaneXResolution='odd' exif:FocalPlaneYResolution='3'", TURNED, "  "),
        (" tiff:ImageWidth='64' b='>'", Motion(64, 48), " tiff:ImageWidth='64' b='>'"),
    ],
)
def test_attributes_follow_the_pixels(before: str, motion: Motion, after: str) -> None:
    assert xmp.moved(packet(before), motion) == packet(after)


def seq(name: str, *values: int) -> str:
    return f"<exif:{name}><rdf:Seq>{''.join(f'<rdf:li>{value}</rdf:li>' for value in values)}</rdf:Seq></exif:{name}>"


REGIONS = (
    "<mwg-rs:Regions a='b'><mwg-rs:AppliedToDimensions stDim:w='64' stDim:h='48' stDim:unit='pixel'/>"
    "<mwg-rs:RegionList>…</mwg-rs:RegionList></mwg-rs:Regions>"
)


@pytest.mark.parametrize(
    ("before", "motion", "after"),
    [
        ("<exif:PixelYDimension>48</exif:PixelYDimension>", TWICE, "<exif:PixelYDimension>96</exif:PixelYDimension>"),
        (seq("SubjectArea", 10, 20, 8, 6), TURNED, seq("SubjectArea", 27, 10, 6, 8)),
        (seq("SubjectArea", 10, 20, 8, 6), TWICE, seq("SubjectArea", 21, 41, 16, 12)),
        (seq("SubjectLocation", 40, 20), PART, ""),
        (seq("SubjectLocation", 10, 20) + "<a/>", PART, seq("SubjectLocation", 2, 16) + "<a/>"),
        ("<exif:SubjectArea/>", TWICE, ""),
        (REGIONS, TWICE, REGIONS.replace("64", "128").replace("48", "96")),
        (REGIONS + "<a/>", PART, "<a/>"),
        (REGIONS, TURNED, ""),
    ],
)
def test_elements_follow_the_pixels(before: str, motion: Motion, after: str) -> None:
    assert xmp.moved(packet("", before), motion) == packet("", after)


def panorama(full: tuple[int, int], crop: tuple[int, int], corner: tuple[int, int], inner: str = "") -> str:
    pairs = {"FullPano": full, "CroppedAreaImage": crop}
    sizes = "".join(f" GPano:{n}WidthPixels='{w}' GPano:{n}HeightPixels='{h}'" for n, (w, h) in pairs.items())
    return sizes + f" GPano:CroppedAreaLeftPixels='{corner[0]}' GPano:CroppedAreaTopPixels='{corner[1]}'" + inner


def test_a_panorama_follows_the_pixels() -> None:
    def moved(motion: Motion) -> bytes:
        inner = " GPano:LargestValidInteriorRectWidth='30'"
        return xmp.moved(packet(panorama((80, 100), (64, 48), (6, 10), inner)), motion)

    inner = " GPano:LargestValidInteriorRectWidth='60'"
    assert moved(TWICE) == packet(panorama((160, 200), (128, 96), (12, 20), inner))
    assert moved(PART) == packet(panorama((80, 100), (16, 20), (14, 14), " "))
    assert b"GPano:" not in moved(TURNED)


PIECES = st.sampled_from(["<", ">", "'", " ", "=", "exif:SubjectArea", "/exif:SubjectArea", "tiff:XResolution", "1/2"])


@given(st.lists(PIECES, max_size=14), st.integers(1, 8))
def test_any_text_may_move(pieces: list[str], turn: int) -> None:
    for motion in (TWICE, PART, Motion(64, 48, turn)):
        assert isinstance(xmp.moved("".join(pieces).encode(), motion), bytes)
