#pragma once

#include "app/terminal/output_file.hpp"
