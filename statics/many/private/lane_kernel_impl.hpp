// Included by the kernel of each set of instructions, behind what it defines: Pack, a vector of pack_width doubles, and
// Bits, one of as many integers of 64 bits; packs, the number of these that make a block; fused(), square_root(),
// rounded_down(), is_any() and the functions on_each_*() of packs.

#include "model/lane_op.hpp"
#include "statics/many/private/lane_kernel.hpp"

namespace {

constexpr size_t lanes_of_block = packs * pack_width;

Bits bits_of(Pack a) { return (Bits)a; }
Pack pack_of(Bits a) { return (Pack)a; }
Pack chosen(Bits where, Pack a, Pack b) { return pack_of((where & bits_of(a)) | (~where & bits_of(b))); }
Pack size_of(Pack a) { return pack_of(bits_of(a) & INT64_MAX); }

struct Place {
  Pack of[packs];
};

void run(const poise::LaneProgram& program, Place* const at) {
  using poise::LaneOp;
  const poise::LaneInstruction* const end = program.first + program.count;
  for (const poise::LaneInstruction* one = program.first; one != end; ++one) {
    Place& to = at[one->to];
    const Place& a = at[one->a];
    const Place& b = at[one->b];
    const Place& c = at[one->c];
#define POISE_EACH(value)                                \
  for (size_t k = 0; k < packs; ++k) to.of[k] = (value); \
  break
    switch (static_cast<LaneOp>(one->op)) {
      case LaneOp::add:
        POISE_EACH(a.of[k] + b.of[k]);
      case LaneOp::subtract:
        POISE_EACH(a.of[k] - b.of[k]);
      case LaneOp::multiply:
        POISE_EACH(a.of[k] * b.of[k]);
      case LaneOp::divide:
        POISE_EACH(a.of[k] / b.of[k]);
      case LaneOp::negate:
        POISE_EACH(pack_of(bits_of(a.of[k]) ^ INT64_MIN));
      case LaneOp::multiply_add:
        POISE_EACH(fused(a.of[k], b.of[k], c.of[k]));
      case LaneOp::multiply_subtract:
        POISE_EACH(fused(a.of[k], b.of[k], -c.of[k]));
      case LaneOp::subtract_product:
        POISE_EACH(fused(-a.of[k], b.of[k], c.of[k]));
      case LaneOp::square_root:
        POISE_EACH(square_root(a.of[k]));
      case LaneOp::absolute:
        POISE_EACH(size_of(a.of[k]));
      case LaneOp::floor:
        POISE_EACH(rounded_down(a.of[k]));
      case LaneOp::least:
        POISE_EACH(chosen(b.of[k] < a.of[k], b.of[k], a.of[k]));
      case LaneOp::greatest:
        POISE_EACH(chosen(a.of[k] < b.of[k], b.of[k], a.of[k]));
      case LaneOp::sine_and_cosine:
        for (size_t k = 0; k < packs; ++k) on_each_sine_and_cosine(a.of[k], to.of[k], at[one->also].of[k]);
        break;
      case LaneOp::sine:
        POISE_EACH(on_each_sine(a.of[k]));
      case LaneOp::cosine:
        POISE_EACH(on_each_cosine(a.of[k]));
      case LaneOp::tangent:
        POISE_EACH(on_each_tangent(a.of[k]));
      case LaneOp::arc_tangent:
        POISE_EACH(on_each_arc_tangent(a.of[k]));
      case LaneOp::arc_tangent_of:
        POISE_EACH(on_each_arc_tangent_of(a.of[k], b.of[k]));
      case LaneOp::exponential:
        POISE_EACH(on_each_exponential(a.of[k]));
      case LaneOp::exponential_less_one:
        POISE_EACH(on_each_exponential_less_one(a.of[k]));
      case LaneOp::logarithm:
        POISE_EACH(on_each_logarithm(a.of[k]));
      case LaneOp::logarithm_of_more:
        POISE_EACH(on_each_logarithm_of_more(a.of[k]));
      case LaneOp::power:
        POISE_EACH(on_each_power(a.of[k], b.of[k]));
      case LaneOp::hyperbolic_sine:
        POISE_EACH(on_each_hyperbolic_sine(a.of[k]));
      case LaneOp::hyperbolic_cosine:
        POISE_EACH(on_each_hyperbolic_cosine(a.of[k]));
      case LaneOp::hyperbolic_tangent:
        POISE_EACH(on_each_hyperbolic_tangent(a.of[k]));
      case LaneOp::less:
        POISE_EACH(pack_of(a.of[k] < b.of[k]));
      case LaneOp::less_or_equal:
        POISE_EACH(pack_of(a.of[k] <= b.of[k]));
      case LaneOp::equal:
        POISE_EACH(pack_of(a.of[k] == b.of[k]));
      case LaneOp::both:
        POISE_EACH(pack_of(bits_of(a.of[k]) & bits_of(b.of[k])));
      case LaneOp::either:
        POISE_EACH(pack_of(bits_of(a.of[k]) | bits_of(b.of[k])));
      case LaneOp::opposite:
        POISE_EACH(pack_of(~bits_of(a.of[k])));
      case LaneOp::choice:
        POISE_EACH(chosen(bits_of(a.of[k]), b.of[k], c.of[k]));
      case LaneOp::constant:
      case LaneOp::input:
        break;
    }
#undef POISE_EACH
  }
}

void prepare(const poise::LaneNewton* newton, double* memory) {
  for (size_t k = 0; k < newton->constant_count; ++k) {
    for (size_t lane = 0; lane < lanes_of_block; ++lane) memory[k * lanes_of_block + lane] = newton->constants[k];
  }
}

void load_numbers(const poise::LaneNewton& newton, const poise::LaneBlock& block, double* memory) {
  for (size_t k = 0; k < newton.numbers; ++k) {
    double* const to = memory + (newton.first_number + k) * lanes_of_block;
    const double* const from = block.numbers[k] + block.strides[k] * block.first;
    if (block.strides[k] == 1 && block.count == lanes_of_block) {
      for (size_t lane = 0; lane < lanes_of_block; ++lane) to[lane] = from[lane];
      continue;
    }
    // Lanes without a variant have that of the last.
    for (size_t lane = 0; lane < lanes_of_block; ++lane) {
      to[lane] = from[block.strides[k] * (lane < block.count ? lane : block.count - 1)];
    }
  }
}

// The largest entry of a step, and where all are at most the longest.
struct Size {
  Pack largest;
  Bits is_within;
};
Size size_of_step(const Place* at, const uint16_t* step, size_t count, size_t pack, double longest) {
  const Pack zero = {};
  Size out{zero, ~Bits{}};
  for (size_t i = 0; i < count; ++i) {
    const Pack size = size_of(at[step[i]].of[pack]);
    out.largest = chosen(size > out.largest, size, out.largest);
    out.is_within &= (Bits)(size <= zero + longest);
  }
  return out;
}

void solve(const poise::LaneNewton* given, double* memory, const poise::LaneBlock* block) {
  const poise::LaneNewton& newton = *given;
  Place* const at = reinterpret_cast<Place*>(memory);
  const size_t n = newton.coordinates;
  const Pack zero = {};
  load_numbers(newton, *block, memory);
  run(newton.once, at);
  // Lanes still under way, those solved, and the size of the last step.
  Bits on_way[packs], solved[packs];
  Pack before[packs];
  Bits any = {};
  for (size_t k = 0; k < packs; ++k) {
    const Size size = size_of_step(at, newton.first_step, n, k, newton.longest);
    const Bits may = size.is_within & bits_of(at[newton.first_mask].of[k]);
    solved[k] = may & (Bits)(size.largest <= zero + newton.tolerance);
    on_way[k] = may & ~solved[k];
    before[k] = size.largest;
    any |= on_way[k];
    for (size_t i = 0; i < n; ++i) {
      at[newton.first_x + i].of[k] = zero + newton.start[i] + at[newton.first_step[i]].of[k];
    }
  }
  for (int steps = 1; steps < newton.most_steps && is_any(any); ++steps) {
    run(newton.step, at);
    Bits ended[packs];
    any = Bits{};
    for (size_t k = 0; k < packs; ++k) {
      const Size size = size_of_step(at, newton.next_step, n, k, newton.longest);
      const Bits is_last = (Bits)(size.largest <= zero + newton.tolerance);
      on_way[k] &= size.is_within & (is_last | (Bits)(size.largest <= newton.contraction * before[k]));
      ended[k] = on_way[k] & is_last;
      before[k] = size.largest;
      any |= ended[k];
    }
    if (is_any(any)) run(newton.check, at);
    any = Bits{};
    for (size_t k = 0; k < packs; ++k) {
      for (size_t i = 0; i < n; ++i) {
        Pack& x = at[newton.first_x + i].of[k];
        x = x + pack_of(on_way[k] & bits_of(at[newton.next_step[i]].of[k]));
      }
      solved[k] |= ended[k] & bits_of(at[newton.last_mask].of[k]);
      on_way[k] &= ~ended[k];
      any |= on_way[k];
    }
  }
  if (newton.value_count > 0) run(newton.values, at);
  for (size_t lane = 0; lane < block->count; ++lane) {
    const bool is_solved = solved[lane / pack_width][lane % pack_width] != 0;
    block->solved[lane] = 0;
    if (!is_solved) continue;
    const double* const of_lane = memory + lane;
    block->solved[lane] = 1;
    for (size_t i = 0; i < n; ++i) {
      block->x[lane * n + i] = newton.units[i] * of_lane[(newton.first_x + i) * lanes_of_block];
    }
    if (newton.value_count == 0) continue;
    if (bits_of(at[newton.values_mask].of[lane / pack_width])[lane % pack_width] != 0) block->solved[lane] = 3;
    for (size_t i = 0; i < newton.value_count; ++i) {
      block->values[lane * newton.value_count + i] = of_lane[newton.value[i] * lanes_of_block];
    }
  }
}

const poise::LaneKernel kernel{lanes_of_block, prepare, solve};

}  // namespace
