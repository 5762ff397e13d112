# What the slice of drum.toml costs in YADE 2023.02 (Debian 12), from the last frame of another program's dump. Without the period along
# the axis, which facets do not bear, so only a few hundredths of a second and no observables. Prints "wall cpu seconds" on a line.
# From the environment: PEERS_DUMP, PEERS_DT, PEERS_TIME.
import os, time
from yade import geom

step, duration = float(os.environ["PEERS_DT"]), float(os.environ["PEERS_TIME"])
lines = open(os.environ["PEERS_DUMP"]).read().rsplit("ITEM: ATOMS", 1)[1].splitlines()[1:]

ball = O.materials.append(FrictMat(young=0.5e6, poisson=0.25, density=2500, frictionAngle=atan(0.7)))
wall = O.materials.append(FrictMat(young=1e9, poisson=0.25, density=2500, frictionAngle=atan(0.7)))
for line in lines:
    x, y, vx, vy, z = map(float, line.split()[:5])
    b = sphere((x, y, z), 0.005, material=ball)
    b.state.vel = (vx, vy, 0)
    O.bodies.append(b)
drum = O.bodies.append(geom.facetCylinder((0, 0, 0.05), 0.375, 0.14, segmentsNumber=240, wallMask=4, material=wall))

O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()]),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],
                    [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.1, es=0.1)], [Law2_ScGeom_MindlinPhys_Mindlin()]),
    NewtonIntegrator(gravity=(0, -9.81, 0), damping=0),
    RotationEngine(rotationAxis=(0, 0, 1), rotateAroundZero=True, zeroPoint=(0, 0, 0), angularVelocity=-2.5, ids=drum),
]
O.dt = step
O.run(20, True)  # finds the contacts
wall_from, cpu_from, steps = time.time(), time.process_time(), int(round(duration / step))
O.run(steps, True)
print("cost", time.time() - wall_from, time.process_time() - cpu_from, steps * step, len(O.interactions))
