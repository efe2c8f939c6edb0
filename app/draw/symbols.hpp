#pragma once

// The signs of an engineering figure. Places and directions are in pixels, y down; directions are unit vectors.

#include <cstddef>
#include <string>
#include <vector>

#include "app/draw/canvas.hpp"

namespace poise::app {

/// The colours of a figure, each with one meaning.
namespace ink {
inline constexpr const char* dark = "#2b343c";    // outlines, ground, text
inline constexpr const char* ground = "#59636c";  // hatching
inline constexpr const char* ghost = "#d3d8dd";   // other positions
inline constexpr const char* load = "#c8202b";
inline constexpr const char* reaction = "#1f5fb4";
inline constexpr const char* drive = "#a3247f";
inline constexpr const char* spring = "#2f7d4f";
inline constexpr const char* slack = "#8fa99a";
inline constexpr const char* damper = "#7a4fa3";
inline constexpr const char* stop = "#d9730d";  // an active one
inline constexpr const char* free_stop = "#a9b0b7";
inline constexpr const char* faint = "#7b858e";  // remarks
}  // namespace ink

/// Fill of the i-th body.
const char* body_colour(int i);

/// How many colours of curves there are.
inline constexpr std::size_t curve_colours = 7;
/// Colour of the i-th curve, after Okabe and Ito in an order in which neighbours differ most, for the colour-blind too:
/// by at least 55 in CIE L*a*b*, and by at least 45 as seen with protanopia or deuteranopia. They repeat.
const char* curve_colour(std::size_t i);

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
void draw_bar(Canvas& canvas, Vec2 a, Vec2 b, double width, const std::string& fill);
/// A cylinder: a barrel from its pin `foot` to its open end `mouth`, and a rod from its `piston` to its pin `eye`.
void draw_cylinder(Canvas& canvas, Vec2 foot, Vec2 mouth, Vec2 piston, Vec2 eye, double width,
                   const std::string& barrel, const std::string& rod);
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
/// A torsion spring as a spiral round `at` that ends in direction `end` at `radius`.
void draw_spiral(Canvas& canvas, Vec2 at, Vec2 end, double radius, const Paint& paint);

/// An arrow from tail to tip.
void draw_arrow(Canvas& canvas, Vec2 tail, Vec2 tip, const std::string& colour, double width,
                const std::string& dash = "");
/// An arrow on a circle round `at`, beginning in direction `from`, counter-clockwise as seen or clockwise.
void draw_turning_arrow(Canvas& canvas, Vec2 at, double radius, Vec2 from, bool counter_clockwise,
                        const std::string& colour, double width, const std::string& dash = "");

/// How far a point is from the line between a and b, ends included.
double distance_to_line(Vec2 point, Vec2 a, Vec2 b);

/// The corners of the convex hull, in order; two for points on one line, one for points that coincide.
std::vector<Vec2> convex_hull(std::vector<Vec2> points);

}  // namespace poise::app
