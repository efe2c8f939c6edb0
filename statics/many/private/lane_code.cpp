#include "statics/many/private/lane_code.hpp"

#include <algorithm>
#include <bit>
#include <initializer_list>
#include <limits>
#include <utility>

namespace poise {

class LaneCode::Generator {
 public:
  Generator(Recording& recording, const RecordedNewton& newton, LaneCode& out)
      : recording_(recording), newton_(newton), out_(out) {}

  void run() {
    find_roots();
    find_what_varies();
    find_members();
    place_what_stays();
    count_uses();
    const std::size_t first_free = places_;
    emit({{&once_members_, &out_.once_}}, {&first_step_, &first_masks_});
    places_after(first_free);
    emit({{&step_members_, &out_.step_}, {&check_members_, &out_.check_}}, {&next_step_, &last_masks_});
    places_after(first_free);
    emit({{&value_members_, &out_.values_}}, {&values_, &value_masks_});
    places_after(first_free);
    fill();
  }

 private:
  using Members = std::vector<int>;
  struct Part {
    const Members* members;
    std::vector<LaneInstruction>* to;
  };

  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  const Recording::Node& node(int index) const { return recording_.nodes()[at(index)]; }

  int root(const Recorded& number) { return number.is_known() ? recording_.constant(number.value()) : number.node(); }
  int root(const RecordedMask& mask) {
    if (!mask.is_known()) return mask.node();
    return recording_.constant(mask.value() ? std::bit_cast<double>(~std::uint64_t{0}) : 0.0);
  }
  Members roots(const std::vector<Recorded>& numbers) {
    Members out;
    for (const Recorded& one : numbers) out.push_back(root(one));
    return out;
  }

  void find_roots() {
    first_step_ = roots(newton_.first_step);
    next_step_ = roots(newton_.next_step);
    values_ = roots(newton_.values);
    first_masks_ = {root(newton_.first_mask)};
    last_masks_ = {root(newton_.last_mask)};
    value_masks_ = {root(newton_.values_mask)};
  }

  void find_what_varies() {
    varies_.assign(recording_.nodes().size(), 0);
    for (const Recorded& one : newton_.x) varies_[at(one.node())] = 1;
    for (std::size_t k = 0; k < varies_.size(); ++k) {
      for (const int of : recording_.nodes()[k].of) {
        if (of >= 0 && varies_[at(of)] != 0) varies_[k] = 1;
      }
    }
  }

  bool is_given(int index) const { return node(index).op == LaneOp::constant || node(index).op == LaneOp::input; }

  // All that the roots need, by flags.
  std::vector<char> needed_by(std::initializer_list<const Members*> roots) const {
    std::vector<char> out(recording_.nodes().size(), 0);
    for (const Members* const some : roots) {
      for (const int one : *some) out[at(one)] = 1;
    }
    for (std::size_t k = out.size(); k-- > 0;) {
      if (out[k] == 0) continue;
      for (const int of : recording_.nodes()[k].of) {
        if (of >= 0) out[at(of)] = 1;
      }
    }
    return out;
  }

  void find_members() {
    const std::vector<char> first = needed_by({&first_step_, &first_masks_}), step = needed_by({&next_step_}),
                            check = needed_by({&last_masks_}), values = needed_by({&values_, &value_masks_});
    stays_.assign(first.size(), 0);
    for (std::size_t k = 0; k < first.size(); ++k) {
      const int index = static_cast<int>(k);
      const bool later = step[k] != 0 || check[k] != 0 || values[k] != 0;
      if (is_given(index)) {
        needed_.push_back(first[k] != 0 || later);
        continue;
      }
      needed_.push_back(false);
      if (varies_[k] == 0) {
        if (first[k] != 0 || later) once_members_.push_back(index);
        continue;
      }
      if (step[k] != 0) step_members_.push_back(index);
      if (check[k] != 0 && step[k] == 0) check_members_.push_back(index);
      if (values[k] != 0) value_members_.push_back(index);
    }
    // What later programs read of what is computed once.
    const auto keep = [&](int index) {
      if (varies_[at(index)] == 0 && !is_given(index)) stays_[at(index)] = 1;
    };
    for (const Members* const members : {&step_members_, &check_members_, &value_members_}) {
      for (const int one : *members) {
        for (const int of : node(one).of) {
          if (of >= 0) keep(of);
        }
      }
    }
    for (const Members* const some : {&next_step_, &last_masks_, &values_, &value_masks_}) {
      for (const int one : *some) keep(one);
    }
  }

  void place_what_stays() {
    place_.assign(recording_.nodes().size(), -1);
    for (std::size_t k = 0; k < place_.size(); ++k) {
      if (!needed_[k] || recording_.nodes()[k].op != LaneOp::constant) continue;
      place_[k] = static_cast<int>(places_++);
      out_.constants_.push_back(recording_.nodes()[k].value);
    }
    out_.newton_.first_number = places_;
    for (const Recorded& one : newton_.numbers) place_[at(one.node())] = static_cast<int>(places_++);
    out_.newton_.first_x = places_;
    for (const Recorded& one : newton_.x) place_[at(one.node())] = static_cast<int>(places_++);
    for (std::size_t k = 0; k < place_.size(); ++k) {
      if (stays_[k] != 0) place_[k] = static_cast<int>(places_++);
    }
    most_places_ = places_;
  }

  void count_uses() {
    uses_.assign(recording_.nodes().size(), 0);
    for (const Members* const members : {&once_members_, &step_members_, &check_members_, &value_members_}) {
      for (const int one : *members) {
        for (const int of : node(one).of) {
          if (of >= 0) ++uses_[at(of)];
        }
      }
    }
    for (const Members* const some :
         {&first_step_, &first_masks_, &next_step_, &last_masks_, &values_, &value_masks_}) {
      for (const int one : *some) ++uses_[at(one)];
    }
  }

  // Nodes with their operands, a product in a sum taken into it, and the cosine beside its sine.
  struct Emitted {
    LaneOp op;
    int node;
    int also = -1;
    std::array<int, 3> of;
  };

  std::vector<Emitted> chosen(const Members& members, std::vector<char>& done) {
    std::vector<char> is_member(recording_.nodes().size(), 0);
    for (const int one : members) is_member[at(one)] = 1;
    const auto is_taken = [&](int of) {
      return is_member[at(of)] != 0 && node(of).op == LaneOp::multiply && uses_[at(of)] == 1 && stays_[at(of)] == 0;
    };
    std::vector<Emitted> out;
    std::vector<char> taken(recording_.nodes().size(), 0);
    for (const int one : members) {
      const Recording::Node& n = node(one);
      if (n.op != LaneOp::add && n.op != LaneOp::subtract) continue;
      if (is_taken(n.of[0]) || is_taken(n.of[1])) taken[at(is_taken(n.of[0]) ? n.of[0] : n.of[1])] = 1;
    }
    for (const int one : members) {
      if (done[at(one)] != 0 || taken[at(one)] != 0) continue;
      done[at(one)] = 1;
      const Recording::Node& n = node(one);
      Emitted emitted{n.op, one, -1, n.of};
      if ((n.op == LaneOp::add || n.op == LaneOp::subtract) && taken[at(n.of[0])] != 0 && is_taken(n.of[0])) {
        const Recording::Node& product = node(n.of[0]);
        emitted.op = n.op == LaneOp::add ? LaneOp::multiply_add : LaneOp::multiply_subtract;
        emitted.of = {product.of[0], product.of[1], n.of[1]};
      } else if ((n.op == LaneOp::add || n.op == LaneOp::subtract) && taken[at(n.of[1])] != 0 && is_taken(n.of[1])) {
        const Recording::Node& product = node(n.of[1]);
        emitted.op = n.op == LaneOp::add ? LaneOp::multiply_add : LaneOp::subtract_product;
        emitted.of = {product.of[0], product.of[1], n.of[0]};
      } else if (n.op == LaneOp::sine || n.op == LaneOp::cosine) {
        const int other = other_of_angle(one);
        if (other >= 0 && done[at(other)] == 0) {
          done[at(other)] = 1;
          emitted.op = LaneOp::sine_and_cosine;
          emitted.node = n.op == LaneOp::sine ? one : other;
          emitted.also = n.op == LaneOp::sine ? other : one;
        }
      }
      out.push_back(emitted);
    }
    return out;
  }

  // The cosine of the angle of a sine, and the reverse, where it is computed in the same programs; else -1.
  int other_of_angle(int index) const {
    const LaneOp wanted = node(index).op == LaneOp::sine ? LaneOp::cosine : LaneOp::sine;
    for (const int one : *current_) {
      if (node(one).op == wanted && node(one).of[0] == node(index).of[0]) return one;
    }
    return -1;
  }

  // Programs that follow each other; what the roots name is kept to their end.
  void emit(const std::vector<Part>& parts, std::initializer_list<const Members*> roots) {
    Members all;
    for (const Part& part : parts) all.insert(all.end(), part.members->begin(), part.members->end());
    current_ = &all;
    std::vector<char> done(recording_.nodes().size(), 0);
    std::vector<std::vector<Emitted>> emitted;
    for (const Part& part : parts) emitted.push_back(chosen(*part.members, done));

    std::vector<int> last(recording_.nodes().size(), -1);
    int position = 0;
    for (const std::vector<Emitted>& some : emitted) {
      for (const Emitted& one : some) {
        for (const int of : one.of) {
          if (of >= 0) last[at(of)] = position;
        }
        ++position;
      }
    }
    for (const Members* const some : roots) {
      for (const int one : *some) last[at(one)] = std::numeric_limits<int>::max();
    }
    std::vector<int> free;
    position = 0;
    const auto is_passing = [&](int index) { return !is_given(index) && stays_[at(index)] == 0; };
    const auto give_place = [&](int index) {
      if (stays_[at(index)] != 0) return;
      if (free.empty()) {
        place_[at(index)] = static_cast<int>(places_++);
      } else {
        place_[at(index)] = free.back();
        free.pop_back();
      }
    };
    for (std::size_t p = 0; p < parts.size(); ++p) {
      for (const Emitted& one : emitted[p]) {
        std::array<int, 3> from{0, 0, 0};
        for (std::size_t k = 0; k < from.size(); ++k) {
          if (one.of[k] >= 0) from[k] = place_[at(one.of[k])];
        }
        // A place is free again behind the last use, even for what is computed there.
        for (std::size_t k = 0; k < from.size(); ++k) {
          const int of = one.of[k];
          const bool is_repeated = (k > 0 && of == one.of[0]) || (k > 1 && of == one.of[1]);
          if (of >= 0 && !is_repeated && is_passing(of) && last[at(of)] == position) free.push_back(from[k]);
        }
        give_place(one.node);
        if (one.also >= 0) give_place(one.also);
        const int also = one.also >= 0 ? place_[at(one.also)] : 0;
        const auto short_of = [](int place) { return static_cast<std::uint16_t>(place); };
        parts[p].to->push_back({static_cast<std::uint16_t>(one.op), short_of(place_[at(one.node)]), short_of(also),
                                short_of(from[0]), short_of(from[1]), short_of(from[2])});
        ++position;
      }
    }
  }

  void places_after(std::size_t first_free) {
    most_places_ = std::max(most_places_, places_);
    places_ = first_free;
  }

  void fill() {
    const auto places_of = [&](const Members& some) {
      std::vector<std::uint16_t> out;
      for (const int one : some) out.push_back(static_cast<std::uint16_t>(place_[at(one)]));
      return out;
    };
    out_.first_step_ = places_of(first_step_);
    out_.next_step_ = places_of(next_step_);
    out_.value_ = places_of(values_);
    LaneNewton& newton = out_.newton_;
    newton.first_mask = places_of(first_masks_).front();
    newton.last_mask = places_of(last_masks_).front();
    newton.values_mask = places_of(value_masks_).front();
    newton.numbers = newton_.numbers.size();
    newton.coordinates = newton_.x.size();
    newton.places = most_places_;
    out_.fits_ = most_places_ <= std::numeric_limits<std::uint16_t>::max();
  }

  Recording& recording_;
  const RecordedNewton& newton_;
  LaneCode& out_;
  Members first_step_, first_masks_, next_step_, last_masks_, values_, value_masks_;
  Members once_members_, step_members_, check_members_, value_members_;
  const Members* current_ = nullptr;  // of the programs that emit() is at
  std::vector<char> varies_, stays_;
  std::vector<bool> needed_;  // of what is given
  std::vector<int> place_, uses_;
  std::size_t places_ = 0, most_places_ = 0;
};

LaneCode::LaneCode(Recording& recording, const RecordedNewton& newton, std::vector<double> units)
    : start_(newton.start), units_(std::move(units)) {
  Generator(recording, newton, *this).run();
  const auto program = [](const std::vector<LaneInstruction>& of) { return LaneProgram{of.data(), of.size()}; };
  newton_.once = program(once_);
  newton_.step = program(step_);
  newton_.check = program(check_);
  newton_.values = program(values_);
  newton_.constants = constants_.data();
  newton_.constant_count = constants_.size();
  newton_.start = start_.data();
  newton_.units = units_.data();
  newton_.first_step = first_step_.data();
  newton_.next_step = next_step_.data();
  newton_.value = value_.data();
  newton_.value_count = value_.size();
}

}  // namespace poise
