#include "app/command_line.hpp"

int main(int argc, char** argv) { return poise::app::run(argc, argv); }
