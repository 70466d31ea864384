# SPDX-License-Identifier: GPL-3.0-or-later
"""Writers of small raster files with numpy and struct only, so that no version of GDAL, HDF5 or zlib changes the bytes.

Arrays are (rows, columns) or (rows, columns, bands); row 0 is the first one in the file. Each writer returns bytes.
"""
import struct
import zlib

import numpy as np

# TIFF types by the letters of Python's struct.
TIFF_TYPES = {"B": 1, "s": 2, "H": 3, "I": 4, "d": 12}
TAG_WIDTH, TAG_HEIGHT, TAG_BITS, TAG_COMPRESSION, TAG_PHOTOMETRIC, TAG_OFFSETS = 256, 257, 258, 259, 262, 273
TAG_BANDS, TAG_ROWS_PER_STRIP, TAG_BYTE_COUNTS, TAG_PLANAR, TAG_EXTRA_SAMPLES, TAG_SAMPLE_FORMAT = 277, 278, 279, 284, 338, 339
TAG_PIXEL_SCALE, TAG_TIE_POINT, TAG_MATRIX, TAG_GEO_KEYS, TAG_GEO_DOUBLES = 33550, 33922, 34264, 34735, 34736
TAG_GDAL_METADATA, TAG_GDAL_NODATA = 42112, 42113
PLAIN, DEFLATE = 1, 8


def utm(zone):
    """GeoTIFF keys of WGS 84 / UTM north."""
    return {1024: 1, 1025: 1, 3072: 32600 + zone}


def sphere(radius_m):
    """GeoTIFF keys of longitude and latitude, in degrees, on a sphere."""
    return {1024: 2, 1025: 1, 2048: 32767, 2050: 32767, 2054: 9102, 2056: 32767, 2057: radius_m, 2058: radius_m}


def on_sphere(radius_m, method, **parameters):
    """GeoTIFF keys of a map in metres: `method` and `parameters` are its ProjCoordTrans and its own keys (k3081=90.0)."""
    return {**sphere(radius_m), 1024: 1, 3072: 32767, 3074: 32767, 3075: method, 3076: 9001,
            **{int(key[1:]): value for key, value in parameters.items()}}


def polar_stereographic(radius_m):
    return on_sphere(radius_m, 15, k3081=90.0, k3082=0.0, k3083=0.0, k3092=1.0, k3095=0.0)


def equirectangular(radius_m):
    return on_sphere(radius_m, 17, k3078=0.0, k3082=0.0, k3083=0.0, k3088=0.0, k3089=0.0)


def orthographic(radius_m, longitude, latitude):
    return on_sphere(radius_m, 21, k3082=0.0, k3083=0.0, k3088=longitude, k3089=latitude)


def geo_tags(keys, transform):
    """Tags of a georeference as in GDAL: x = t0 + t1 column + t2 row, y = t3 + t4 column + t5 row, at a pixel's outer corner."""
    x, dx, x_row, y, y_column, dy = transform
    if x_row == 0 and y_column == 0 and dy < 0:
        tags = {TAG_PIXEL_SCALE: ("d", [dx, -dy, 0]), TAG_TIE_POINT: ("d", [0, 0, 0, x, y, 0])}
    else:
        tags = {TAG_MATRIX: ("d", [dx, x_row, 0, x, y_column, dy, 0, y, 0, 0, 0, 0, 0, 0, 0, 1])}
    if not keys:
        return tags
    entries, doubles = [], []
    for key, value in sorted(keys.items()):
        if isinstance(value, float):
            entries += [key, TAG_GEO_DOUBLES, 1, len(doubles)]
            doubles.append(value)
        else:
            entries += [key, 0, 1, value]
    tags[TAG_GEO_KEYS] = ("H", [1, 1, 0, len(keys), *entries])
    if doubles:
        tags[TAG_GEO_DOUBLES] = ("d", doubles)
    return tags


def stored_zlib(data):
    """A zlib stream of uncompressed blocks."""
    blocks = [data[i:i + 65535] for i in range(0, len(data), 65535)] or [b""]
    body = b"".join(struct.pack("<BHH", i == len(blocks) - 1, len(block), len(block) ^ 0xffff) + block
                    for i, block in enumerate(blocks))
    return b"\x78\x01" + body + struct.pack(">I", zlib.adler32(data))


def tiff_of(tags, pieces, order="<"):
    """A TIFF of these tags {number: (type, values or bytes)}; the pieces of samples follow, their offsets filled in."""
    tags = dict(tags)
    tags.setdefault(TAG_OFFSETS, ("I", [0] * len(pieces)))
    tags.setdefault(TAG_BYTE_COUNTS, ("I", [len(piece) for piece in pieces]))
    packed = {tag: value if letter == "s" else struct.pack(order + letter * len(value), *value)
              for tag, (letter, value) in tags.items()}
    beyond = 8 + 2 + 12 * len(tags) + 4
    begin = beyond + sum(len(value) + len(value) % 2 for value in packed.values() if len(value) > 4)
    letter, offsets = tags[TAG_OFFSETS]
    if not any(offsets):
        offsets = [begin + sum(map(len, pieces[:i])) for i in range(len(pieces))]
        packed[TAG_OFFSETS] = struct.pack(order + letter * len(offsets), *offsets)
    directory, values = struct.pack(order + "H", len(tags)), b""
    for tag in sorted(tags):
        letter, value = tags[tag][0], packed[tag]
        count = len(value) if letter == "s" else len(tags[tag][1])
        directory += struct.pack(order + "HHI", tag, TIFF_TYPES[letter], count)
        if len(value) > 4:
            directory += struct.pack(order + "I", beyond + len(values))
            values += value + b"\0" * (len(value) % 2)
        else:
            directory += value.ljust(4, b"\0")
    mark = b"II*\0" if order == "<" else b"MM\0*"
    return mark + struct.pack(order + "I", 8) + directory + b"\0" * 4 + values + b"".join(pieces)


def tiff_tags(values, compression=PLAIN):
    """The tags that describe how the samples of an array are stored in one strip."""
    rows, columns, bands = values.shape if values.ndim == 3 else (*values.shape, 1)
    kind = {"u": 1, "i": 2, "f": 3}[values.dtype.kind]
    extra = {TAG_EXTRA_SAMPLES: ("H", [0] * (bands - 1))} if bands > 1 else {}
    return {**extra, TAG_WIDTH: ("I", [columns]), TAG_HEIGHT: ("I", [rows]), TAG_BITS: ("H", [8 * values.itemsize] * bands),
            TAG_COMPRESSION: ("H", [compression]), TAG_PHOTOMETRIC: ("H", [1]), TAG_BANDS: ("H", [bands]),
            TAG_ROWS_PER_STRIP: ("I", [rows]), TAG_PLANAR: ("H", [1]), TAG_SAMPLE_FORMAT: ("H", [kind] * bands)}


def tiff(values, keys=None, transform=None, nodata=None, scale_offset=None, compression=PLAIN, order="<"):
    """A (Geo)TIFF in one strip; `nodata` is the text of GDAL's tag, `scale_offset` the scale and offset of pixel values."""
    tags = tiff_tags(values, compression)
    if transform is not None:
        tags |= geo_tags(keys, transform)
    if scale_offset is not None:
        items = "".join(f'<Item name="{name}" sample="0" role="{role}">{value}</Item>'
                        for name, role, value in zip(("SCALE", "OFFSET"), ("scale", "offset"), scale_offset))
        tags[TAG_GDAL_METADATA] = ("s", f"<GDALMetadata>{items}</GDALMetadata>\0".encode())
    if nodata is not None:
        tags[TAG_GDAL_NODATA] = ("s", nodata.encode() + b"\0")
    data = values.astype(values.dtype.newbyteorder(order)).tobytes()
    return tiff_of(tags, [stored_zlib(data) if compression == DEFLATE else data], order)


def png(values):
    """An 8-bit grey PNG."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows, columns = values.shape
    lines = b"".join(b"\0" + row.tobytes() for row in values.astype(np.uint8))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", stored_zlib(lines)) + chunk(b"IEND", b""))


def netcdf_grid(longitude, latitude, values, attributes):
    """A netCDF grid z(lat, lon), classic format, float32; `attributes` of z are texts or float32."""
    def text(value):
        data = value.encode()
        return struct.pack(">I", len(data)) + data + b"\0" * (-len(data) % 4)

    def attribute_list(items):
        packed = b"".join(text(name) + (struct.pack(">I", 2) + text(value) if isinstance(value, str)
                                        else struct.pack(">IIf", 5, 1, value)) for name, value in items.items())
        return struct.pack(">II", 12, len(items)) + packed if items else b"\0" * 8

    axis = {"lon": {"long_name": "longitude", "units": "degrees_east"}, "lat": {"long_name": "latitude", "units": "degrees_north"}}
    variables = [("lat", [0], axis["lat"], 6, np.asarray(latitude, ">f8")), ("lon", [1], axis["lon"], 6, np.asarray(longitude, ">f8")),
                 ("z", [0, 1], attributes, 5, np.asarray(values, ">f4"))]
    dimensions = struct.pack(">II", 10, 2) + text("lat") + struct.pack(">I", len(latitude)) + text("lon") + struct.pack(">I", len(longitude))
    head = b"CDF\x01" + b"\0" * 4 + dimensions + attribute_list({"Conventions": "CF-1.7"}) + struct.pack(">II", 11, len(variables))

    def described(offset):
        result = head
        for name, dims, items, kind, data in variables:
            result += text(name) + struct.pack(f">{1 + len(dims)}I", len(dims), *dims) + attribute_list(items)
            result += struct.pack(">III", kind, data.nbytes, offset)
            offset += data.nbytes
        return result
    return described(len(described(0))) + b"".join(data.tobytes() for *_, data in variables)


def ascii_grid(values, corner, cell, nodata=None):
    head = f"ncols {values.shape[1]}\nnrows {values.shape[0]}\nxllcorner {corner[0]}\nyllcorner {corner[1]}\ncellsize {cell}\n"
    if nodata is not None:
        head += f"NODATA_value {nodata}\n"
    return (head + "".join(" ".join(f"{value:g}" for value in row) + "\n" for row in values)).encode()


def vicar(values):
    """A VICAR file of big-endian int16, with a label that fills whole records."""
    rows, columns = values.shape
    record = 2 * columns
    size = -(-300 // record) * record
    label = (f"LBLSIZE={size} FORMAT='HALF' TYPE='IMAGE' BUFSIZ={record} DIM=3 EOL=0 RECSIZE={record} ORG='BSQ' NL={rows} NS={columns} "
             f"NB=1 N1={columns} N2={rows} N3=1 N4=0 NBB=0 NLB=0 HOST='SUN-4' INTFMT='HIGH' REALFMT='IEEE'")
    return label.ljust(size, "\0").encode() + values.astype(">i2").tobytes()


def dted(values, longitude, latitude):
    """A cell of 1 degree whose south-western corner is given, whole degrees east and north; -32767 is a hole."""
    posts, lines = values.shape
    interval = 36000 // (lines - 1), 36000 // (posts - 1)
    uhl = (f"UHL1{longitude:03}0000E{latitude:03}0000N{interval[0]:04}{interval[1]:04}0010U  " + " " * 12 +
           f"{lines:04}{posts:04}0").ljust(80)
    dsi = (("DSIU".ljust(59) + "DTED0".ljust(85) + "WGS84").ljust(289) + "00").ljust(648)
    acc = "ACC0010001000100010".ljust(2700)
    data = (uhl + dsi + acc).encode()
    for line, heights in enumerate(values[::-1].T):
        signed = np.where(heights < 0, 0x8000 | -heights.astype(int), heights).astype(">u2")
        record = struct.pack(">BBHHH", 0o252, 0, line, line, 0) + signed.tobytes()
        data += record + struct.pack(">I", sum(record))
    return data


RAW_VRT = """<VRTDataset rasterXSize="{columns}" rasterYSize="{rows}">
  <SRS>{crs}</SRS>
  <GeoTransform>{transform}</GeoTransform>
  <VRTRasterBand dataType="Int16" band="1" subClass="VRTRawRasterBand">
    <SourceFilename relativeToVRT="1">{name}</SourceFilename>
    <ImageOffset>0</ImageOffset>
    <PixelOffset>2</PixelOffset>
    <LineOffset>{line}</LineOffset>
    <ByteOrder>MSB</ByteOrder>
  </VRTRasterBand>
</VRTDataset>
"""


def raw_vrt(values, name, crs, transform):
    """The VRT of a headerless file of big-endian int16."""
    rows, columns = values.shape
    return RAW_VRT.format(columns=columns, rows=rows, crs=crs, transform=", ".join(map(str, transform)), name=name,
                          line=2 * columns).encode()


def mosaic_vrt(shape, transform, crs, tiles):
    """A VRT of tiles [(name, first column)] side by side, each of half the width."""
    rows, columns = shape
    half = columns // 2
    sources = "".join(
        f'    <SimpleSource>\n      <SourceFilename relativeToVRT="1">{name}</SourceFilename>\n      <SourceBand>1</SourceBand>\n'
        f'      <SrcRect xOff="0" yOff="0" xSize="{half}" ySize="{rows}"/>\n'
        f'      <DstRect xOff="{first}" yOff="0" xSize="{half}" ySize="{rows}"/>\n    </SimpleSource>\n' for name, first in tiles)
    return (f'<VRTDataset rasterXSize="{columns}" rasterYSize="{rows}">\n  <SRS>{crs}</SRS>\n'
            f"  <GeoTransform>{', '.join(map(str, transform))}</GeoTransform>\n"
            f'  <VRTRasterBand dataType="Int16" band="1">\n{sources}  </VRTRasterBand>\n</VRTDataset>\n').encode()
