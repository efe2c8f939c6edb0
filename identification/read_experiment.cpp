#include "identification/experiment.hpp"
