"""Scenes that several tests read."""

#: A mass hangs on a spring: k (y - y0) + m g = 0 in N and mm.
MASS_ON_SPRING = """
gravity = [0, -9810]
[units]
length = "mm"
[ground]
points = { O = [0, 0] }
[body.block]
points = { P = [0, 0] }
mass = 2
center = [0, 0]
[[slide]]
name = "rail"
points = ["ground.O", "block.P"]
axis = [0, 1]
[[spring]]
name = "k"
slide = "rail"
stiffness = 4
free_length = 100
[start]
rail = 90
"""

#: A block that nothing holds.
FALLS = """
title = "A block that nothing holds"
gravity = [0, -9.81]
[ground]
points = { O = [0, 0] }
[body.block]
points = { S = [0, 0] }
mass = 1
[[slide]]
name = "rail"
points = ["ground.O", "block.S"]
axis = [0, 1]
"""
