"""Reads a series and a checkpoint with VTK and h5py and compares every number.

    python3 check_readers.py FOLDER

FOLDER holds series.pvd, state.vtkhdf and, under expected/, one raw little-endian file per array:
NAME.TYPE.COMPONENTS, for example velocity.float32.3.
"""

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

folder = Path(sys.argv[1])


class Errors:
    """Collects what VTK complains about; its readers do not raise."""

    def __init__(self, reader):
        self.messages = []
        self.CallDataType = vtk.VTK_STRING
        for event in ("ErrorEvent", "WarningEvent"):
            reader.AddObserver(event, self)

    def __call__(self, _caller, event, text="") -> None:
        self.messages.append(f"{event}: {text}")


def grid(path):
    reader = vtk.vtkHDFReader() if path.suffix == ".vtkhdf" else vtk.vtkXMLUnstructuredGridReader()
    errors = Errors(reader)
    reader.SetFileName(str(path))
    reader.Update()
    assert not errors.messages, (path, errors.messages)
    out = reader.GetOutput()
    assert out.GetClassName() == "vtkUnstructuredGrid", out.GetClassName()
    return out


def expected_arrays():
    arrays = {}
    for path in sorted((folder / "expected").iterdir()):
        name, kind, components = path.name.rsplit(".", 2)
        values = np.fromfile(path, dtype=np.dtype(kind).newbyteorder("<"))
        arrays[name] = values if components == "1" else values.reshape(-1, int(components))
    return arrays


def same(found, expected, what):
    assert found.shape == expected.shape, (what, found.shape, expected.shape)
    assert found.dtype.kind == expected.dtype.kind, (what, found.dtype, expected.dtype)
    assert found.dtype.itemsize == expected.dtype.itemsize, (what, found.dtype)
    # Compared as bytes: -0.0 is not 0.0.
    assert found.tobytes() == expected.tobytes(), what


def in_space(values):
    """Vectors of the plane are stored with a zero third component."""
    if values.ndim == 2 and values.shape[1] == 2:
        return np.hstack([values, np.zeros((len(values), 1), values.dtype)])
    return values


def check_grid(out, arrays, time, what):
    n = len(arrays["Points"])
    assert out.GetNumberOfPoints() == n, (what, out.GetNumberOfPoints())
    assert out.GetNumberOfCells() == n, (what, out.GetNumberOfCells())
    for i in {0, n // 2, n - 1} if n else ():
        assert out.GetCellType(i) == vtk.VTK_VERTEX, what
        assert out.GetCell(i).GetPointId(0) == i, what
    assert out.GetFieldData().GetArray("TimeValue").GetValue(0) == time, what
    data = out.GetPointData()
    names = {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())}
    if n == 0:
        return
    assert names == set(arrays) - {"Points"}, (what, names)
    same(vtk_to_numpy(out.GetPoints().GetData()), in_space(arrays["Points"]), (what, "Points"))
    for name in names:
        same(vtk_to_numpy(data.GetArray(name)), in_space(arrays[name]), (what, name))


arrays = expected_arrays()
entries = ElementTree.parse(folder / "series.pvd").getroot().findall("Collection/DataSet")
moving = [e for e in entries if e.get("part") == "0"]
fixed = [e for e in entries if e.get("part") == "1"]
assert [float(e.get("timestep")) for e in moving] == [0.0, 0.25], entries
assert len({e.get("file") for e in fixed}) == 1 and len(fixed) == 2, entries
for entry in moving:
    time = float(entry.get("timestep"))
    shown = arrays if time == 0.0 else {name: a[::-1] for name, a in arrays.items()}
    check_grid(grid(folder / entry.get("file")), shown, time, entry.get("file"))
assert grid(folder / fixed[0].get("file")).GetNumberOfPoints() == 3

check_grid(grid(folder / "state.vtkhdf"), arrays, 0.5, "state.vtkhdf")
with h5py.File(folder / "state.vtkhdf") as file:
    same(file["VTKHDF/Points"][:], in_space(arrays["Points"]), "Points")
    for name in set(arrays) - {"Points"}:
        same(file["VTKHDF/PointData"][name][:], in_space(arrays[name]), name)
    head = file["sph"].attrs
    assert head["time"] == 0.5 and head["step"] == 120 and head["dt"] == 1e-4
    assert head["scene"] == "# Fluß\ndimension = 3\n", head["scene"]
    assert head["particles"] == len(arrays["Points"])
    assert list(head["body"]) == [0.5, -1.5]

print(f"{len(arrays['Points'])} particles agree")
