#pragma once

#include "app/terminal/interrupt.hpp"
