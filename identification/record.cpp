#include "identification/record.hpp"
