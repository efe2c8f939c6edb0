#pragma once

#include <filesystem>

namespace poise {

/// What a design file asks for, as its tables tell.
enum class DesignKind {
  guidance,   ///< [goal]: a point along a straight line and a level body (motion/design.hpp)
  synthesis,  ///< [synthesis]: linkages through given points, poses or angles
  balance,    ///< [balance]: springs and counterweights that balance weights or shaking
  goals       ///< [[goal]]: numbers of a scene for which quantities are as wanted
};

/// Throws InputError where the file cannot be read or has none of these tables, or tables of two kinds.
DesignKind kind_of_design(const std::filesystem::path& file);

}  // namespace poise
