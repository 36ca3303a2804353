"""Opens the snapshots and checkpoints of a run with VTK and h5py and prints what they hold as JSON.

    python3 read_outputs.py FOLDER
"""

import json
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

folder = Path(sys.argv[1])
NEEDED = {"velocity", "pressure", "density", "kind", "id"}


class Errors:
    """Collects what VTK complains about; its readers do not raise."""

    def __init__(self, reader):
        self.messages = []
        self.CallDataType = vtk.VTK_STRING
        for event in ("ErrorEvent", "WarningEvent"):
            reader.AddObserver(event, self)

    def __call__(self, _caller, event, text=""):
        self.messages.append(f"{event}: {text}")


def grid(path):
    reader = vtk.vtkHDFReader() if path.suffix == ".vtkhdf" else vtk.vtkXMLUnstructuredGridReader()
    errors = Errors(reader)
    reader.SetFileName(str(path))
    reader.Update()
    assert not errors.messages, (path, errors.messages)
    out = reader.GetOutput()
    assert out.GetClassName() == "vtkUnstructuredGrid", out.GetClassName()
    assert out.GetNumberOfCells() == out.GetNumberOfPoints(), path
    return out


def arrays(path):
    """Positions and point arrays by name."""
    out = grid(path)
    data = out.GetPointData()
    found = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
    found["Points"] = vtk_to_numpy(out.GetPoints().GetData())
    for name, values in found.items():
        assert len(values) == out.GetNumberOfPoints(), (path, name)
        assert np.all(np.isfinite(values)), (path, name)
    return found


report = {"snapshots": [], "checkpoints": []}
(index,) = folder.glob("*.pvd")
for entry in ElementTree.parse(index).getroot().findall("Collection/DataSet"):
    found = arrays(folder / entry.get("file"))
    assert NEEDED <= set(found), (entry.get("file"), set(found))
    assert found["velocity"].shape[1] == 3, found["velocity"].shape
    assert found["id"].dtype.kind == "u" and len(np.unique(found["id"])) == len(found["id"])
    report["snapshots"].append(
        {
            "time": float(entry.get("timestep")),
            "part": int(entry.get("part")),
            "points": len(found["id"]),
            "fluid": int(np.sum(found["kind"] == 0)),
            "largest_speed": float(np.max(np.linalg.norm(found["velocity"], axis=1))),
            "front": float(np.max(found["Points"][:, 0])),
        }
    )

for path in sorted(folder.glob("*.vtkhdf")):
    found = arrays(path)
    # A checkpoint holds the fluid; walls are made anew from the scene.
    columns = {"velocity", "density", "mass", "pressure_gradient", "id"}
    assert columns <= set(found), (path, set(found))
    with h5py.File(path) as file:
        head = dict(file["sph"].attrs)
        points = file["VTKHDF/Points"][:]
        assert points.dtype == np.float64 and points.tobytes() == found["Points"].tobytes()
        for name in columns:
            assert len(file["VTKHDF/PointData"][name]) == len(points), name
        assert len(np.unique(file["VTKHDF/PointData/id"][:])) == len(points)
        report["checkpoints"].append(
            {
                "time": float(head["time"]),
                "step": int(head["step"]),
                "points": len(points),
                "mass": float(np.sum(found["mass"])),
                "scene": str(head["scene"]),
            }
        )

json.dump(report, sys.stdout)
