#pragma once

#include "app/present/numbers.hpp"
