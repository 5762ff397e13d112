#include "postproc/export/paraview_script.h"

namespace drumsweep {

const char* const paraview_script =
    R"py(# Opens this export in ParaView: balls as spheres of their size, coloured by speed, walls from their inside.
#   paraview --script=open_in_paraview.py
#   pvpython open_in_paraview.py PICTURE.png     without a window
import os
import sys
from paraview.simple import *

folder = os.path.dirname(os.path.abspath(__file__)) if '__file__' in globals() else os.getcwd()
view = GetActiveViewOrCreate('RenderView')
view.UseColorPaletteForBackground = 0
view.Background = [1.0, 1.0, 1.0]
view.OrientationAxesLabelColor = [0.1, 0.1, 0.1]

for name in sorted(os.listdir(folder)):
    if not name.endswith('.xmf') or name in ('balls.xmf', 'landings.xmf'):
        continue
    wall = XDMFReader(registrationName=name, FileNames=[os.path.join(folder, name)])
    display = Show(wall, view)
    if name != 'belt.xmf':
        display.BackfaceRepresentation = 'Cull Backface'
    display.ColorArrayName = [None, '']

balls = XDMFReader(registrationName='balls.xmf', FileNames=[os.path.join(folder, 'balls.xmf')])
spheres = Glyph(registrationName='spheres', Input=balls, GlyphType='Sphere')
spheres.OrientationArray = ['POINTS', 'No orientation array']
spheres.ScaleArray = ['POINTS', 'diameter_m']
spheres.ScaleFactor = 1.0
spheres.GlyphMode = 'All Points'
spheres.GlyphType.ThetaResolution = 16
spheres.GlyphType.PhiResolution = 12
display = Show(spheres, view)
ColorBy(display, ('POINTS', 'speed_m_s'))
display.RescaleTransferFunctionToDataRange(False, True)
GetColorTransferFunction('speed_m_s').ApplyPreset('Viridis (matplotlib)', True)
display.SetScalarBarVisibility(view, True)
bar = GetScalarBar(GetColorTransferFunction('speed_m_s'), view)
bar.Title = 'speed (m/s)'
bar.ComponentTitle = ''
bar.RangeLabelFormat = '%.2g'
bar.TitleColor = bar.LabelColor = [0.1, 0.1, 0.1]
bar.TitleFontSize = bar.LabelFontSize = 14

GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
view.ViewTime = GetTimeKeeper().TimestepValues[-1] if len(GetTimeKeeper().TimestepValues) else 0.0
camera = GetActiveCamera()
camera.SetFocalPoint(0, 0, 0)
camera.SetPosition(0.86, 0.44, 0.34)
camera.SetViewUp(0, 0, 1)
if len(sys.argv) > 1:
    view.ViewSize = [1200, 800]
ResetCamera()
camera.Zoom(1.15)
Render()
if len(sys.argv) > 1 and sys.argv[-1].endswith('.png'):
    SaveScreenshot(sys.argv[-1], view, ImageResolution=[1200, 800])
)py";

}  // namespace drumsweep
