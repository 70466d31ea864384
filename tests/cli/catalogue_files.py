# SPDX-License-Identifier: GPL-3.0-or-later
"""Input files for the catalogue of error messages; most of them have one defect each."""
import json
import os
import shutil
import struct

import h5py
import numpy as np

from harness import EVAL, REGRID, SCAN, TERRAIN, as_of_0_2_0, clouds, run, write_file
from harness.opencl import build_faulty_opencl

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
# A raster of 13 x 13 pixels of 1 m, and a CRS for it.
ASC = "ncols {0}\nnrows {1}\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n"
WGS84 = ('GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
         'UNIT["degree",0.0174532925199433]]')
UTM = ('PROJCS["UTM",' + WGS84 + ',PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],'
       'PARAMETER["central_meridian",-3],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],'
       'PARAMETER["false_northing",0],UNIT["metre",1]]')
GEOCENTRIC = ('GEOCCS["earth",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
              'UNIT["metre",1]]')
SOURCE = ('<SimpleSource><SourceFilename relativeToVRT="1">{}</SourceFilename><SourceBand>1</SourceBand>'
          "</SimpleSource>")


def edited(path, source, change):
    """A copy of an HDF5 file with one change."""
    shutil.copy(source, path)
    with h5py.File(path, "r+") as file:
        change(file)


def asc(values):
    rows = [" ".join(f"{value:g}" for value in row) for row in values]
    return ASC.format(len(values[0]), len(values)) + "\n".join(rows) + "\n"


def vrt(content, head="", data_type="Float32"):
    return (f'<VRTDataset rasterXSize="13" rasterYSize="13">{head}<VRTRasterBand dataType="{data_type}" band="1">'
            f"{content}</VRTRasterBand></VRTDataset>")


def add_albedo(file, value):
    file["albedo"] = np.full(file["z"].shape, value, np.float32)
    for key in ("grid_mapping", "units"):
        if key in file["z"].attrs:
            file["albedo"].attrs[key] = file["z"].attrs[key]


def replaced(name, values):
    """A change that rewrites a dataset with another shape or other values."""
    def change(file):
        attributes = dict(file[name].attrs)
        del file[name]
        file[name] = values
        for key, value in attributes.items():
            if key not in ("DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME", "_Netcdf4Dimid", "_FillValue"):
                file[name].attrs[key] = value
    return change


def value_at(name, index, value):
    def change(file):
        file[name][index] = value
    return change


def removed(name):
    def change(file):
        del file[name]
    return change


def attribute(name, value):
    def change(file):
        file.attrs[name] = value
    return change


def damaged(path, source, name):
    """A copy of a file in which the stored bytes of a dataset are overwritten."""
    shutil.copy(source, path)
    with h5py.File(path) as file:
        dataset = file[name]
        chunk = dataset.id.get_chunk_info(0) if dataset.chunks else None
        offset, size = (chunk.byte_offset, chunk.size) if chunk else (dataset.id.get_offset(), 64)
    with open(path, "r+b") as raw:
        raw.seek(offset)
        raw.write(b"\xa5" * min(size, 64))


def run_quietly(*arguments):
    result = run(*arguments)
    if (result.returncode, result.stderr) != (0, ""):
        raise AssertionError(f"{arguments}: {result.stderr}")


def make_draws():
    write_file("mc.json", json.dumps({"draws": 3, "metrics": "verdict", "regrid": REGRID, "eval": EVAL}))
    draws_config = ["monte-carlo", "full_scan.h5", "--terrain", "terrain.h5", "-c", "mc.json"]
    for name, draws in (("a", "0:1"), ("b", "1:3"), ("b_again", "0:2"), ("c", "2:3")):
        run_quietly(*draws_config, "--draws", draws, "-o", f"part_{name}.h5")
    run_quietly(*draws_config, "--set", "scan.seed=8", "--draws", "1:3", "-o", "part_other.h5")

    def too_many(file):
        file["state/invalid"][7] = 2
    edited("part_edited.h5", "part_a.h5", too_many)
    edited("part_old.h5", "part_a.h5", as_of_0_2_0)
    edited("part_no_seed.h5", "part_a.h5", removed("draws/seed"))
    edited("part_no_first.h5", "part_a.h5", lambda file: file["draws"].attrs.pop("first_draw"))


def make_chain():
    for name, config in [("terrain", TERRAIN), ("scan", SCAN), ("regrid", REGRID), ("eval", EVAL)]:
        write_file(name + ".json", json.dumps(config))
    run_quietly("terrain-gen", "-c", "terrain.json", "-o", "terrain.h5")
    run_quietly("terrain-gen", "-c", "terrain.json", "-o", "other_terrain.h5", "--set", "base.elevation_m=0")
    scan = ["scan-sim", "-c", "scan.json", "--terrain", "terrain.h5", "-o"]
    run_quietly(*scan, "scan.h5")
    run_quietly(*scan, "float_scan.h5", "--float32", "--keep-misses")
    run_quietly(*scan, "incidence_scan.h5", "--set", "noise.incidence_sigma_rad=0.001")
    run_quietly(*scan, "quiet_scan.h5", "--set", "noise.range_sigma_m=0.02")
    run_quietly(*scan, "full_scan.h5", "--keep-misses")
    link = ["--set", "link.reference_pe=100", "--set", "link.reference_range_m=50", "--set", "detector.subpixels=2",
            "--keep-misses"]
    for name, of_receiver in (("waveform_scan.h5", {"type": "peak"}), ("returns_scan.h5", {"type": "peak", "returns": "all"}),
                              ("geiger_scan.h5", {"type": "geiger"})):
        run_quietly(*scan, name, *link, "--set", "receiver=" + json.dumps(of_receiver))
    run_quietly(*scan, "moved_scan.h5", "--set", "trajectory.position_m.0=0.6")
    run_quietly("regrid", "scan.h5", "-c", "regrid.json", "--terrain", "terrain.h5", "-o", "dem.h5")
    run_quietly("regrid", "scan.h5", "-c", "regrid.json", "-o", "no_truth_dem.h5")
    run_quietly("dem-eval", "dem.h5", "-c", "eval.json", "-o", "eval.h5")
    run_quietly("dem-eval", "dem.h5", "-c", "eval.json", "--metrics-only", "-o", "metrics_only.h5")
    run_quietly("hazard-map", "dem.h5", "-o", "hazards.h5")
    make_draws()
    write_file("tetra.obj", TETRAHEDRON)
    run_quietly("terrain-gen", "--from", "tetra.obj", "-o", "mesh.h5")


def linked(link):
    def change(file):
        del file["z_est"]
        file["z_est"] = link
    return change


def created(**options):
    def change(file):
        file.create_dataset("extra", dtype="f8", **options)
    return change


def compressed_by_blosc(file):
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_chunk((4,))
    properties.set_filter(32001, h5py.h5z.FLAG_OPTIONAL, (2,))
    h5py.h5d.create(file.id, b"extra", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((8,)), properties)


def virtual_z_est(file):
    shape = file["z_est"].shape
    del file["z_est"]
    layout = h5py.VirtualLayout(shape, "f8")
    layout[...] = h5py.VirtualSource("eval.h5", "e_z", shape)
    file.create_virtual_dataset("z_est", layout)


def external_z_est(file):
    shape = file["z_est"].shape
    del file["z_est"]
    file.create_dataset("z_est", shape, "f8", external=[("values.bin", 0, h5py.h5f.UNLIMITED)])


def number_as_scales(file):
    del file["z_est"].attrs["DIMENSION_LIST"]
    file["z_est"].attrs["DIMENSION_LIST"] = 2


def make_files_with_external_data():
    edited("linked.h5", "dem.h5", linked(h5py.ExternalLink("eval.h5", "/e_z")))
    edited("soft_linked.h5", "dem.h5", linked(h5py.SoftLink("/count")))
    edited("virtual.h5", "dem.h5", virtual_z_est)
    edited("apart.h5", "dem.h5", external_z_est)
    edited("blosc.h5", "dem.h5", compressed_by_blosc)
    edited("huge.h5", "dem.h5", created(shape=(1 << 20, 1 << 20), chunks=(256, 256)))
    edited("unlinked.h5", "dem.h5", number_as_scales)
    edited("huge_chunk.h5", "dem.h5", created(shape=(1 << 13, 1 << 13), chunks=(1 << 13, 1 << 13)))


def make_broken_landfall_files():
    write_file("text.h5", "no HDF5 at all\n")
    write_file("empty.h5", "")
    with open("dem.h5", "rb") as whole, open("cut.h5", "wb") as cut:
        cut.write(whole.read()[:5000])
    with h5py.File("foreign.h5", "w") as file:
        file["x"] = 1
    with h5py.File("two_layers.h5", "w") as file:
        file["a"] = file["b"] = np.zeros((4, 4))
    with h5py.File("times.h5", "w") as file:
        file["t_s"] = [0.0, 1.0]
    with h5py.File("groups.h5", "w") as file, h5py.File("matrix.h5", "w") as other:
        for name in ("t_s", "x_m", "y_m", "z_m"):
            file["a/" + name] = file["b/" + name] = [0.0, 1.0]
            other[name] = np.zeros((2, 2))
    with h5py.File("cube.h5", "w") as file:
        for name in ("t_s", "x_m", "y_m", "z_m"):
            file[name] = np.zeros(2)
        file["vx_mps"] = np.zeros((2, 1, 1))
    edited("incomplete.h5", "dem.h5", attribute("complete", 0))
    edited("newer.h5", "dem.h5", attribute("format_version", "2.0"))
    with h5py.File("terrain.h5") as file:
        z, x = file["z"][:], file["x"][:]
    edited("no_z.h5", "terrain.h5", removed("z"))
    edited("no_x.h5", "terrain.h5", removed("x"))
    edited("short_z.h5", "terrain.h5", replaced("z", z[:-1]))
    edited("flat_x.h5", "terrain.h5", replaced("x", np.zeros((2, 2))))
    edited("uneven_x.h5", "terrain.h5", value_at("x", 3, x[3] + 0.03))
    edited("falling_x.h5", "terrain.h5", value_at("x", slice(None), x[::-1]))
    edited("infinite_z.h5", "terrain.h5", value_at("z", (0, 0), np.inf))
    edited("holes_z.h5", "terrain.h5", value_at("z", slice(None), np.nan))
    edited("bright.h5", "terrain.h5", lambda file: add_albedo(file, 1.5))
    damaged("damaged_z.h5", "terrain.h5", "z")
    edited("no_points.h5", "scan.h5", removed("points"))
    edited("no_column.h5", "scan.h5", removed("points/z_est"))
    with h5py.File("scan.h5") as file:
        pulse = file["points/pulse"][:]
    edited("short_column.h5", "scan.h5", replaced("points/pulse", pulse[:-1]))
    edited("bad_pulse.h5", "scan.h5", value_at("points/pulse", 5, 12345))
    edited("not_finite.h5", "scan.h5", value_at("points/z_est", 5, np.nan))
    with h5py.File("full_scan.h5") as file:
        last_return = np.flatnonzero(file["points/status"][:] == 0)[-1]
    edited("not_finite_after_misses.h5", "full_scan.h5", value_at("points/x_est", last_return, np.nan))
    edited("no_pulse_time.h5", "full_scan.h5", value_at("pulses/t", 399, np.nan))
    damaged("damaged_points.h5", "scan.h5", "points/z_est")
    edited("no_z_est.h5", "dem.h5", removed("z_est"))
    edited("infinite_z_est.h5", "dem.h5", value_at("z_est", (50, 50), np.inf))
    with h5py.File("dem.h5") as file:
        shape = file["z_est"].shape
    edited("negative_sigma.h5", "dem.h5", lambda file: file.create_dataset("z_sigma_rel", data=np.full(shape, -0.05, "f4")))
    damaged("damaged_z_est.h5", "dem.h5", "z_est")
    make_files_with_external_data()
    edited("no_history.h5", "scan.h5", removed("provenance"))
    edited("no_poses.h5", "scan.h5", removed("pulses/pz_est"))
    edited("short_poses.h5", "scan.h5", replaced("pulses/pz_est", np.zeros(3)))
    edited("no_pose_values.h5", "scan.h5", value_at("pulses/pz_est", 7, np.nan))
    edited("falling_times.h5", "scan.h5", value_at("pulses/t", 7, 0))
    edited("bad_begin.h5", "full_scan.h5", value_at("pulses/point_begin", 7, 10**9))
    edited("bad_pixel.h5", "full_scan.h5", value_at("points/pixel", 7, 9999))
    with h5py.File("full_scan.h5") as file:
        ranges = file["points/range_true"][:]
    edited("few_ranges.h5", "full_scan.h5", replaced("points/range_true", ranges[:-1]))
    edited("no_return.h5", "scan.h5", value_at("points/status", slice(None), 1))
    edited("far_scan.h5", "scan.h5", value_at("points/x_est", 5, 1e6))
    edited("odd_metrics.h5", "eval.h5", replaced("metrics_json", "{}"))
    edited("old_scan.h5", "scan.h5", lambda file: file["provenance"].attrs.__setitem__("version", "0.0.1"))
    with h5py.File("dem.h5") as dem, h5py.File("no_bin.h5", "w") as file:
        file["mask"] = np.zeros(dem["z_est"].shape, np.int8)
        file["corner"] = np.ones((3, 3), np.int8)
    edited("mesh_no_triangles.h5", "mesh.h5", removed("mesh/triangles"))
    edited("mesh_bad_corner.h5", "mesh.h5", value_at("mesh/triangles", (1, 2), 99))
    edited("mesh_negative_corner.h5", "mesh.h5", value_at("mesh/triangles", (1, 2), -1))
    edited("mesh_not_finite.h5", "mesh.h5", value_at("mesh/vertices", (1, 2), np.nan))
    edited("mesh_no_area.h5", "mesh.h5", value_at("mesh/triangles", (1, slice(None)), 1))
    edited("no_mesh.h5", "mesh.h5", replaced("mesh", np.zeros(3)))
    edited("mesh_flat_shape.h5", "mesh.h5", replaced("mesh/vertices", np.zeros(12)))


def make_rasters():
    slope = [[column + 0.5 * row for column in range(13)] for row in range(13)]
    write_file("dem.asc", asc(slope))
    write_file("dem_crs.asc", asc(slope))
    write_file("dem_crs.prj", UTM)
    write_file("dem.vrt", vrt(SOURCE.format("dem_crs.asc"), f"<SRS>{UTM}</SRS><GeoTransform>0,1,0,13,0,-1</GeoTransform>"))
    write_file("line.asc", asc(slope[:1]))
    write_file("bad_nodata.asc", asc([row[:6] + [-3.4e38] + row[7:] for row in slope]))
    write_file("holes.asc", asc([[-9999 if 4 <= row <= 8 and 4 <= column <= 8 else 1 for column in range(13)]
                                 for row in range(13)]))
    write_file("chess.asc", asc([[-9999 if (row + column) % 2 else 1 for column in range(13)] for row in range(13)]))
    write_file("big.vrt", vrt("").replace('"13"', '"30000"'))
    write_file("beyond_pole.vrt", vrt(SOURCE.format("dem.asc"), f"<SRS>{WGS84}</SRS>"
                                      "<GeoTransform>0,0.001,0,95.01,0,-0.001</GeoTransform>"))
    write_file("complex.vrt", vrt(SOURCE.format("dem.asc"), data_type="CFloat32"))
    write_file("zero_scale.vrt", vrt("<Scale>0</Scale>" + SOURCE.format("dem.asc")))
    write_file("missing.vrt", vrt(SOURCE.format("nowhere.asc")))
    write_file("pipe.vrt", vrt(SOURCE.format("pipe")))
    write_file("no_transform.vrt", vrt(SOURCE.format("dem.asc"), f"<SRS>{UTM}</SRS>"))
    write_file("flat_transform.vrt", vrt(SOURCE.format("dem.asc"),
                                         f"<SRS>{UTM}</SRS><GeoTransform>0,1,0,0,1,0</GeoTransform>"))
    write_file("geocentric.vrt", vrt(SOURCE.format("dem.asc"),
                                     f"<SRS>{GEOCENTRIC}</SRS><GeoTransform>0,1,0,0,0,1</GeoTransform>"))
    shutil.copy(os.path.join(os.environ["LANDFALL_ROOT"], "testdata", "malformed", "netcdf_truncated.nc"), "cut.nc")
    write_file("cut.tif", b"II*\0" + struct.pack("<I", 8) + b"\x05")


def make_las():
    points = clouds.las_points(2)
    good = clouds.las(points)

    def patched(name, at, form, value):
        write_file(name + ".las", good[:at] + struct.pack(form, value) + good[at + struct.calcsize(form):])

    write_file("good.las", good)
    write_file("cut.las", good[:-1])
    write_file("cut_header.las", good[:100])
    patched("version", 25, "<B", 5)
    patched("short_header", 94, "<H", 100)
    patched("early_points", 96, "<I", 10)
    patched("cut_record", 100, "<I", 9)
    patched("format", 104, "<B", 11)
    patched("packed", 104, "<B", 0x80)
    patched("short_points", 105, "<H", 19)
    patched("no_points", 107, "<I", 0)
    patched("no_scale", 131, "<d", 0)
    for name, record in (("packed_record", ("laszip encoded", 22204, b"x")), ("bad_keys", ("LASF_Projection", 34735, bytes(8))),
                         *((name, ("LASF_Projection", 34735, struct.pack("<12H", 1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, code)))
                           for name, code in (("unknown_code", 29999), ("heights_code", 5703))),
                         ("bad_wkt", ("LASF_Projection", 2112, b"PROJCS["))):
        write_file(name + ".las", clouds.las(points, records=[clouds.las_vlr(*record)]))
    write_file("more_points.las", good + bytes(20))
    write_file("extra_bytes.las", clouds.las(points, records=[clouds.las_vlr("LASF_Spec", 4, b"\0\0\x0a".ljust(192, b"\0"))]))
    patched("by_return", 111, "<I", 9)
    corners = [{**points[0], "xyz": (0, 0, 0), "class": 2}, {**points[0], "xyz": (1000, 1000, 0), "class": 2}]
    write_file("other_box.las", clouds.las(corners, box=[0.5, 0, 1, 0, 0, 0]))
    good = clouds.las(points, 6, 4)
    patched("two_counts", 107, "<I", 3)
    good = good[:243] + struct.pack("<I", 1) + good[247:]
    patched("early_records", 235, "<Q", 400)


def make_pcd():
    good = clouds.pcd(np.zeros(40, [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]), "binary_compressed")
    body = good.index(b"compressed\n") + 11
    packed, unpacked = struct.unpack_from("<II", good, body)
    write_file("cut.pcd", good[:-1])
    write_file("sizes.pcd", good[:body] + struct.pack("<II", packed, unpacked - 1) + good[body + 8:])
    write_file("early.pcd", good[:body] + struct.pack("<II", packed - 3, unpacked) + good[body + 8:])
    write_file("before.pcd", good[:body + 8] + b"\xff\xff\xff" + good[body + 11:])


def make_qfit():
    head = struct.pack(">12i", 48, *[0] * 11)
    shots = head + struct.pack(">12i", -9000008, 96, *[0] * 10) + struct.pack(">12i", *range(12))
    write_file("qfit_record.qi", head + struct.pack(">12i", *range(12)))
    write_file("qfit_offset.qi", shots[:52] + struct.pack(">i", 48) + shots[56:])
    write_file("qfit_cut.qi", shots[:-1])


def make_imports():
    make_las()
    make_pcd()
    make_qfit()
    write_file("far.asc", asc([[1, 2], [3, 4]]).replace("corner 0", "corner 500"))
    write_file("oblong.asc", asc([[1, 2], [3, 4]]).replace("cellsize 1", "dx 1\ndy 2"))
    write_file("empty.asc", asc([[-9999, -9999], [-9999, -9999]]))
    write_file("degrees.vrt", vrt(SOURCE.format("dem.asc"), f"<SRS>{WGS84}</SRS><GeoTransform>9,0.001,0,48,0,-0.001</GeoTransform>"))
    write_file("imported.csv", "x,y,z,t\n0,0,1,0\n1,1,2,1\n")
    run("landfall-import", "imported.csv", "-o", "imported.h5", "-q")


def make_files():
    """Makes all files in the current folder."""
    make_chain()
    make_broken_landfall_files()
    make_rasters()
    os.mkdir("folder")
    os.mkdir("bad_plugin")
    write_file("bad_plugin/landfall-gdal.so", "no library\n")
    write_file("bad_plugin/landfall-opencl.so", "no library\n")
    os.mkdir("bad_opencl")
    write_file("bad_opencl/libOpenCL.so.1", "no library\n")
    build_faulty_opencl("faulty_opencl.so")
    write_file("old.h5", "an older output\n")
    for name in ("pipe", "pipe.obj"):
        os.mkfifo(name)
    write_file("cut.ply", b"ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
                          b"end_header\n\x03\0\0")
    write_file("long.ply", b"ply\nformat binary_little_endian 1.0\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n\x03\0\0")
    write_file("short.stl", b" " * 80 + struct.pack("<I", 7) + b"\0" * 60)
    make_imports()
