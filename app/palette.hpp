#pragma once

#include "app/terminal/palette.hpp"
