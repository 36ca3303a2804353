#!/usr/bin/env python3
"""Renders snapshots of a dam break side by side.

Usage: python3 docs/render.py OUT/NAME.pvd picture.png T1 [T2 ...]

Needs vtk (pip install vtk). Fluid is coloured by speed; solids other than the first (the tank) are
drawn grey; the box is that of the tank's fluid side. Colours, view and wall thickness suit the
scenes of this project.
"""

import os
import sys
import xml.etree.ElementTree as ET

import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def read(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def spheres(points, radius, colour=None, values=None, top=1.0):
    data = vtk.vtkPolyData()
    coordinates = vtk.vtkPoints()
    coordinates.SetData(numpy_to_vtk(points, deep=True))
    data.SetPoints(coordinates)
    mapper = vtk.vtkPointGaussianMapper()
    mapper.SetInputData(data)
    mapper.SetScaleFactor(radius)
    mapper.EmissiveOff()
    # A shaded ball from each splat, without any geometry.
    mapper.SetSplatShaderCode(
        "//VTK::Color::Impl\n"
        "float d2 = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);\n"
        "if (d2 > 1.0) { discard; }\n"
        "float light = 0.35 + 0.65 * sqrt(1.0 - d2);\n"
        "ambientColor *= light; diffuseColor *= light;\n"
    )
    if values is not None:
        scalars = numpy_to_vtk(values, deep=True)
        data.GetPointData().SetScalars(scalars)
        table = vtk.vtkColorTransferFunction()
        table.SetColorSpaceToLab()
        for at, rgb in [(0.0, (0.05, 0.15, 0.45)), (0.35, (0.1, 0.45, 0.8)),
                        (0.7, (0.55, 0.85, 0.95)), (1.0, (1.0, 1.0, 1.0))]:
            table.AddRGBPoint(at * top, *rgb)
        mapper.SetLookupTable(table)
        mapper.SetScalarRange(0, top)
    else:
        mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    if colour:
        actor.GetProperty().SetColor(*colour)
    return actor


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    index, picture, times = sys.argv[1], sys.argv[2], [float(t) for t in sys.argv[3:]]
    folder = os.path.dirname(index)
    entries = [(float(d.get("timestep")), d.get("file")) for d in ET.parse(index).iter("DataSet")]
    moving = [(t, f) for t, f in entries if not f.endswith("walls.vtu")]
    walls = next((f for _, f in entries if f.endswith("walls.vtu")), None)

    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(560 * len(times), 420)
    for k, time in enumerate(times):
        shown, name = min(moving, key=lambda entry: abs(entry[0] - time))
        fluid = read(os.path.join(folder, name))
        points = vtk_to_numpy(fluid.GetPoints().GetData()).astype("f4")
        velocity = vtk_to_numpy(fluid.GetPointData().GetArray("velocity"))
        speed = (velocity ** 2).sum(axis=1) ** 0.5
        flat = bool((points[:, 2] == points[0, 2]).all())
        up = 1 if flat else 2
        first = read(os.path.join(folder, moving[0][1]))
        start = vtk_to_numpy(first.GetPoints().GetData())
        extent = start.max(axis=0) - start.min(axis=0)
        space = extent[0] * extent[1] * (1 if flat else extent[2])
        spacing = float((space / len(start)) ** (1 / (2 if flat else 3)))
        height = float(extent[up])

        renderer = vtk.vtkRenderer()
        renderer.SetViewport(k / len(times), 0, (k + 1) / len(times), 1)
        renderer.SetBackground(1, 1, 1)
        top = 2.0 * (9.81 * height) ** 0.5
        renderer.AddActor(spheres(points, 0.62 * spacing, values=speed.astype("f4"), top=top))
        if walls:
            solid = read(os.path.join(folder, walls))
            kind = vtk_to_numpy(solid.GetPointData().GetArray("kind"))
            where = vtk_to_numpy(solid.GetPoints().GetData()).astype("f4")
            if (kind > 1).any():
                renderer.AddActor(spheres(where[kind > 1], 0.62 * spacing, colour=(0.45, 0.42, 0.4)))
            tank = where[kind == 1]
            thickness = 3.0 * spacing
            low, high = tank.min(axis=0) + thickness, tank.max(axis=0) - thickness
            if flat:
                low[2] = high[2] = 0.0
            box = vtk.vtkOutlineSource()
            box.SetBounds(low[0], high[0], low[1], high[1], low[2], high[2])
            edges = vtk.vtkPolyDataMapper()
            edges.SetInputConnection(box.GetOutputPort())
            outline = vtk.vtkActor()
            outline.SetMapper(edges)
            outline.GetProperty().SetColor(0.3, 0.3, 0.3)
            outline.GetProperty().SetLineWidth(1.5)
            renderer.AddActor(outline)
        label = vtk.vtkTextActor()
        label.SetInput(f"t = {shown:.2f} s")
        label.GetTextProperty().SetColor(0.1, 0.1, 0.1)
        label.GetTextProperty().SetFontSize(20)
        label.SetPosition(12, 12)
        renderer.AddViewProp(label)
        renderer.ResetCamera()
        camera = renderer.GetActiveCamera()
        if flat:
            camera.ParallelProjectionOn()
        else:
            focus = camera.GetFocalPoint()
            camera.SetPosition(focus[0] + 1.1, focus[1] - 2.4, focus[2] + 1.0)
            camera.SetViewUp(0, 0, 1)
        renderer.ResetCamera()
        camera.Zoom(1.35)
        renderer.ResetCameraClippingRange()
        window.AddRenderer(renderer)
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(picture)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    main()
