#pragma once

#include "app/terminal/progress.hpp"
