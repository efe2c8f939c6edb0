#pragma once

// The signs of an engineering figure. Places and directions are in pixels, y down; directions are unit vectors.

#include <string_view>
#include <vector>

#include "app/draw/canvas.hpp"
#include "app/draw/palette.hpp"

namespace poise::app {

/// The angle, rad counter-clockwise as seen, of a direction on the page.
double seen_angle(Vec2 direction);

/// A pinned support: triangle with its tip at `at`, standing on hatched ground that lies in direction `down`.
void draw_support(Canvas& canvas, Vec2 at, Vec2 down);
/// A line of ground from a to b, hatched on the side of `down`.
void draw_ground(Canvas& canvas, Vec2 a, Vec2 b, Vec2 down);

void draw_pin(Canvas& canvas, Vec2 at, double radius);
/// A quartered disc: the centre of mass.
void draw_centre_of_mass(Canvas& canvas, Vec2 at, double radius);

/// A bar with round ends, `width` px thick, with a rim.
void draw_bar(Canvas& canvas, Vec2 a, Vec2 b, double width, Colour fill);
/// A cylinder: a barrel from its pin `foot` to its open end `mouth`, and a rod from its `piston` to its pin `eye`.
void draw_cylinder(Canvas& canvas, Vec2 foot, Vec2 mouth, Vec2 piston, Vec2 eye, double width, Colour barrel,
                   Colour rod);
/// A massless bar: two thin lines.
void draw_massless_bar(Canvas& canvas, Vec2 a, Vec2 b, double width);
/// A block, its length along `axis`.
void draw_block(Canvas& canvas, Vec2 at, Vec2 axis, double length, double height, const Paint& paint);
/// A slot with round ends from a to b.
void draw_slot(Canvas& canvas, Vec2 a, Vec2 b, double width, const Paint& paint);

/// A line spring from a to b as a zigzag, the part between its ends moved sideways by `shift`.
void draw_spring(Canvas& canvas, Vec2 a, Vec2 b, Vec2 shift, const Paint& paint);
/// A damper from a to b: a piston in an open pot, moved in the same way.
void draw_dashpot(Canvas& canvas, Vec2 a, Vec2 b, Vec2 shift, const Paint& paint);
/// A gas strut from a to b: a closed tube towards a, with the piston of the rod in it, moved in the same way.
void draw_gas_strut(Canvas& canvas, Vec2 a, Vec2 b, Vec2 shift, const Paint& paint);
/// A torsion spring as a spiral round `at` that ends in direction `end` at `radius`.
void draw_spiral(Canvas& canvas, Vec2 at, Vec2 end, double radius, const Paint& paint);
/// A motor: an M in a circle.
void draw_motor(Canvas& canvas, Vec2 at, double radius, const Paint& paint);
/// A controller: a C in a square.
void draw_controller(Canvas& canvas, Vec2 at, double radius, const Paint& paint);

/// Parts of a Geneva drive over the distance of its axes, in their own frames: the outline of a wheel with a slot along
/// x, and that of the locking disc of a crank with its pin along x. The half width of a slot is the radius of the pin.
std::vector<Vec2> geneva_wheel(int slots);
std::vector<Vec2> geneva_disc(int slots);
double geneva_pin_radius(int slots);

/// A blade as seen from above: a lens along its edge, so long to both sides.
void draw_blade(Canvas& canvas, Vec2 at, Vec2 along, double half_length, Colour colour);

/// An arrow from tail to tip.
void draw_arrow(Canvas& canvas, Vec2 tail, Vec2 tip, Colour colour, double width, std::string_view dash = {});
/// An arrow on a circle round `at`, beginning in direction `from`, counter-clockwise as seen or clockwise.
void draw_turning_arrow(Canvas& canvas, Vec2 at, double radius, Vec2 from, bool counter_clockwise, Colour colour,
                        double width, std::string_view dash = {});

/// Rays around a place, from one distance from it to another: something hits there.
void draw_burst(Canvas& canvas, Vec2 at, double from, double to, const Paint& paint);

/// How far a point is from the line between a and b, ends included.
double distance_to_line(Vec2 point, Vec2 a, Vec2 b);

/// The corners of the convex hull, in order; two for points on one line, one for points that coincide.
std::vector<Vec2> convex_hull(std::vector<Vec2> points);

}  // namespace poise::app
