# What each mutant changes, and so which error its tests must notice. Changes that make bounds wider only, and no result
# wrong, do not belong here.

# --- interval.hpp: bounds of operations -----------------------------------------------------------------------------

mutant("2 pi is not enclosed" solvers/interval.hpp
  [=[full_turn(0x1.921fb54442d18p+2,]=]
  [=[full_turn(0x1.921fb54442d19p+2,]=])
mutant("width rounded downwards" solvers/interval.hpp
  [=[return upper_ + minus_lower_;]=]
  [=[return -(-upper_ - minus_lower_);]=])
mutant("magnitude of the upper bound only" solvers/interval.hpp
  [=[return greater(minus_lower_, upper_);]=]
  [=[return upper_ < 0 ? -upper_ : upper_;]=])
mutant("magnitude without NaN of the lower bound" solvers/interval.hpp
  [=[return greater(minus_lower_, upper_);]=]
  [=[return minus_lower_ > upper_ ? minus_lower_ : upper_;]=])
mutant("mignitude without zero" solvers/interval.hpp
  [=[(upper_ < 0 ? -upper_ : 0.0)]=]
  [=[(upper_ < 0 ? -upper_ : 0.5 * upper_)]=])
mutant("zero at the end of an interval is excluded" solvers/interval.hpp
  [=[return minus_lower_ < 0 || upper_ < 0;]=]
  [=[return minus_lower_ <= 0 || upper_ < 0;]=])
mutant("lower bound of a sum rounded upwards" solvers/interval.hpp
  [=[from(a.minus_lower_ + b.minus_lower_, a.upper_ + b.upper_)]=]
  [=[from(-(-a.minus_lower_ - b.minus_lower_), a.upper_ + b.upper_)]=])
mutant("upper bound of a sum rounded downwards" solvers/interval.hpp
  [=[from(a.minus_lower_ + b.minus_lower_, a.upper_ + b.upper_)]=]
  [=[from(a.minus_lower_ + b.minus_lower_, -(-a.upper_ - b.upper_))]=])
mutant("lower bound of a difference rounded upwards" solvers/interval.hpp
  [=[from(a.minus_lower_ + b.upper_, a.upper_ + b.minus_lower_)]=]
  [=[from(-(-a.minus_lower_ - b.upper_), a.upper_ + b.minus_lower_)]=])
mutant("upper bound of a difference rounded downwards" solvers/interval.hpp
  [=[from(a.minus_lower_ + b.upper_, a.upper_ + b.minus_lower_)]=]
  [=[from(a.minus_lower_ + b.upper_, -(-a.upper_ - b.minus_lower_))]=])
mutant("bounds of the opposite not exchanged" solvers/interval.hpp
  [=[return from(a.upper_, a.minus_lower_);]=]
  [=[return from(-a.minus_lower_, -a.upper_);]=])
mutant("upper bound of a product without a corner" solvers/interval.hpp
  [=[most(a.minus_lower_ * b.minus_lower_, al * b.upper_, a.upper_ * bl, a.upper_ * b.upper_)]=]
  [=[most(a.minus_lower_ * b.minus_lower_, al * b.upper_, al * b.upper_, a.upper_ * b.upper_)]=])
mutant("lower bound of a product without a corner" solvers/interval.hpp
  [=[most(al * b.minus_lower_, a.minus_lower_ * b.upper_, a.upper_ * b.minus_lower_, -a.upper_ * b.upper_)]=]
  [=[most(al * b.minus_lower_, al * b.minus_lower_, a.upper_ * b.minus_lower_, -a.upper_ * b.upper_)]=])
mutant("a corner of a product rounded downwards" solvers/interval.hpp
  [=[most(a.minus_lower_ * b.minus_lower_, al * b.upper_, a.upper_ * bl, a.upper_ * b.upper_)]=]
  [=[most(a.minus_lower_ * b.minus_lower_, al * b.upper_, a.upper_ * bl, -(-a.upper_ * b.upper_))]=])
mutant("a product with NaN has bounds" solvers/interval.hpp
  [=[if (std::isnan(any)) return from(any, any);]=]
  [=[]=])
mutant("a corner of a product's lower bound rounded upwards" solvers/interval.hpp
  [=[a.upper_ * b.minus_lower_, -a.upper_ * b.upper_)]=]
  [=[a.upper_ * b.minus_lower_, -(a.upper_ * b.upper_))]=])
mutant("any two that are equal make a square" solvers/interval.hpp
  [=[if (&a == &b) return square(a);]=]
  [=[if (a.lower() == b.lower() && a.upper() == b.upper()) return square(a);]=])
mutant("lower bound of a square rounded upwards" solvers/interval.hpp
  [=[from(-least * least, greatest * greatest)]=]
  [=[from(-(least * least), greatest * greatest)]=])
mutant("upper bound of a square rounded downwards" solvers/interval.hpp
  [=[from(-least * least, greatest * greatest)]=]
  [=[from(-least * least, -(-greatest * greatest))]=])
mutant("a division by what may be zero has bounds" solvers/interval.hpp
  [=[if (!b.excludes_zero()) return entire();]=]
  [=[]=])
mutant("upper bound of a quotient without a corner" solvers/interval.hpp
  [=[greatest(a.minus_lower_ / b.minus_lower_, al / b.upper_, a.upper_ / bl, a.upper_ / b.upper_)]=]
  [=[greatest(a.minus_lower_ / b.minus_lower_, al / b.upper_, a.upper_ / bl, al / b.upper_)]=])
mutant("lower bound of a quotient without a corner" solvers/interval.hpp
  [=[greatest(al / b.minus_lower_, a.minus_lower_ / b.upper_, a.upper_ / b.minus_lower_, -a.upper_ / b.upper_)]=]
  [=[greatest(al / b.minus_lower_, a.minus_lower_ / b.upper_, a.upper_ / b.minus_lower_, al / b.minus_lower_)]=])
mutant("a corner of a quotient rounded downwards" solvers/interval.hpp
  [=[greatest(a.minus_lower_ / b.minus_lower_, al / b.upper_, a.upper_ / bl, a.upper_ / b.upper_)]=]
  [=[greatest(a.minus_lower_ / b.minus_lower_, -(a.minus_lower_ / b.upper_), a.upper_ / bl, a.upper_ / b.upper_)]=])
mutant("lower bound of a root not lowered" solvers/interval.hpp
  [=[-root + root * std::numeric_limits<double>::epsilon() : -root;]=]
  [=[-root : -root;]=])
mutant("upper bound of a root rounded downwards" solvers/interval.hpp
  [=[std::sqrt(a.upper_ > 0 ? a.upper_ : (a.upper_ <= 0 ? 0.0 : a.upper_))]=]
  [=[std::nextafter(std::sqrt(a.upper_ > 0 ? a.upper_ : 0.0), 0.0)]=])
mutant("lower bound of a root of what is below zero" solvers/interval.hpp
  [=[a.minus_lower_ < 0 ? -a.minus_lower_ : 0.0;]=]
  [=[a.minus_lower_ < 0 ? -a.minus_lower_ : a.minus_lower_;]=])
mutant("the less of two numbers is proved for their middles" solvers/interval.hpp
  [=[return a.upper_ < -b.minus_lower_;]=]
  [=[return a.middle() < b.middle();]=])
mutant("at most is proved for their lower bounds" solvers/interval.hpp
  [=[return a.upper_ <= -b.minus_lower_;]=]
  [=[return -a.minus_lower_ <= -b.minus_lower_;]=])
mutant("absolute values without those of negative numbers" solvers/interval.hpp
  [=[from(-a.mignitude(), a.magnitude())]=]
  [=[from(-a.mignitude(), a.upper_)]=])
mutant("a hull has the lower bound of the first" solvers/interval.hpp
  [=[from(greater(a.minus_lower_, b.minus_lower_), greater(a.upper_, b.upper_))]=]
  [=[from(a.minus_lower_, greater(a.upper_, b.upper_))]=])
mutant("a hull has the upper bound of the first" solvers/interval.hpp
  [=[from(greater(a.minus_lower_, b.minus_lower_), greater(a.upper_, b.upper_))]=]
  [=[from(greater(a.minus_lower_, b.minus_lower_), a.upper_)]=])
mutant("a meeting in one number is empty" solvers/interval.hpp
  [=[return !(minus_lower_ + upper_ < 0 || -minus_lower_ > upper_);]=]
  [=[return !(minus_lower_ + upper_ <= 0 || -minus_lower_ > upper_);]=])
mutant("the upper bound of what is met is taken in any case" solvers/interval.hpp
  [=[if (b.upper_ < upper_) upper_ = b.upper_;]=]
  [=[if (!(b.upper_ > upper_)) upper_ = b.upper_;]=])
mutant("the maximum of zero and a negative number is negative" solvers/interval.hpp
  [=[a.upper_ < 0 ? 0.0 : a.upper_]=]
  [=[a.upper_]=])
mutant("zero is not put in" solvers/interval.hpp
  [=[return hull(a, Interval(0.0));]=]
  [=[return a;]=])
mutant("the greatest of NaN and a number is the number" solvers/interval.hpp
  [=[return a > b || std::isnan(a) ? a : b;]=]
  [=[return a > b || std::isnan(b) ? a : b;]=])

# --- interval.cpp: sine, cosine, angles -----------------------------------------------------------------------------

mutant("pi/2 of 66 bits" solvers/interval.cpp
  [=[Interval(k) * Interval(half_pi_rest_below, half_pi_rest_above);
  const Interval z]=]
  [=[Interval(0);
  const Interval z]=])
mutant("the series ends early without its remainder" solvers/interval.cpp
  [=[for (int i = static_cast<int>(Terms) - 2; i >= 0; --i)]=]
  [=[for (int i = static_cast<int>(Terms) - 4; i >= 0; --i)]=])
mutant("sine and cosine of the second quadrant with one sign" solvers/interval.cpp
  [=[return {-s, c};]=]
  [=[return {s, c};]=])
mutant("sine and cosine of the last quadrant of the first" solvers/interval.cpp
  [=[return {s, -c};]=]
  [=[return {s, c};]=])
mutant("no extreme values of sine and cosine" solvers/interval.cpp
  [=[if (!at.meet(angle)) continue;]=]
  [=[if (at.meet(angle) || true) continue;]=])
mutant("maxima are taken for minima" solvers/interval.cpp
  [=[Interval((j & 3) < 2 ? 1 : -1)]=]
  [=[Interval((j & 3) < 2 ? -1 : 1)]=])
mutant("sine of the lower end only" solvers/interval.cpp
  [=[ends = {hull(a.x, b.x), hull(a.y, b.y)};]=]
  [=[ends = {hull(a.x, b.x), a.y};]=])
mutant("angle of a vector without its correction" solvers/interval.cpp
  [=[return Interval(guess) + Interval(-slope, slope);]=]
  [=[return Interval(guess);]=])
mutant("angle of a vector corrected to one side" solvers/interval.cpp
  [=[return Interval(guess) + Interval(-slope, slope);]=]
  [=[return Interval(guess) + Interval(0, slope);]=])
mutant("a box around zero has an angle" solvers/interval.cpp
  [=[if (!x.excludes_zero() && !y.excludes_zero()) return Interval::entire();]=]
  [=[]=])
mutant("wrong first corner of a box above" solvers/interval.cpp
  [=[above ? x.upper() : (below]=]
  [=[above ? x.lower() : (below]=])
mutant("wrong last corner of a box on the left" solvers/interval.cpp
  [=[(below || !right ? x.upper() : x.lower())]=]
  [=[(below || !right ? x.lower() : x.upper())]=])
mutant("wrong first corner of a box on the right" solvers/interval.cpp
  [=[right ? y.lower() : (left || !above]=]
  [=[right ? y.upper() : (left || !above]=])
mutant("wrong last corner of a box on the right" solvers/interval.cpp
  [=[right ? y.upper() : (left || above]=]
  [=[right ? y.lower() : (left || above]=])
mutant("the last corner at another turn than the first" solvers/interval.cpp
  [=[first.middle() + std::numbers::pi / 2]=]
  [=[near - 2]=])

# --- box_prover.cpp: closures ---------------------------------------------------------------------------------------

mutant("products with negative factors thin" statics/all_equilibria/private/interval_matrix.hpp
  [=[sum.minus_lower() + -factor * a.upper()]=]
  [=[sum.minus_lower() + factor * a.minus_lower()]=])
mutant("arms without the width of lengths on them" statics/all_equilibria/private/box_prover.cpp
  [=[sum += box[along.length] * along.direction;]=]
  [=[sum += Interval(box[along.length].middle()) * along.direction;]=])
mutant("the first turn is left out" statics/all_equilibria/private/box_prover.cpp
  [=[/ solvers::full_turn.upper()) - 1;]=]
  [=[/ solvers::full_turn.upper()) + 2;]=])
mutant("the last turn is left out" statics/all_equilibria/private/box_prover.cpp
  [=[/ solvers::full_turn.upper()) + 2;]=]
  [=[/ solvers::full_turn.upper()) - 1;]=])
mutant("of several turns the last" statics/all_equilibria/private/box_prover.cpp
  [=[all = hull(all, part);]=]
  [=[all = part;]=])
mutant("a sliver below an arm's angle" statics/all_equilibria/private/box_prover.cpp
  [=[return solvers::angle_of(turned.x, turned.y, box[group.angle].middle());]=]
  [=[const Interval angle = solvers::angle_of(turned.x, turned.y, box[group.angle].middle());
    return Interval(angle.lower() + 1e-9, angle.upper());]=])
mutant("a sliver above an arm's angle" statics/all_equilibria/private/box_prover.cpp
  [=[return solvers::angle_of(turned.x, turned.y, box[group.angle].middle());]=]
  [=[const Interval angle = solvers::angle_of(turned.x, turned.y, box[group.angle].middle());
    return Interval(angle.lower(), angle.upper() - 1e-9);]=])
mutant("a sliver of an arm's length" statics/all_equilibria/private/box_prover.cpp
  [=[if (!length.meet(square_of_length)) return false;]=]
  [=[if (!length.meet(square_of_length * Interval(1 + 1e-9, 1 + 1e-9))) return false;]=])
mutant("a component of an arm without the width of the other" statics/all_equilibria/private/box_prover.cpp
  [=[square_of_length - square(other);]=]
  [=[square_of_length - square(Interval(other.middle()));]=])
mutant("an arm on one side only" statics/all_equilibria/private/box_prover.cpp
  [=[{angle_of(sides[0]), angle_of(sides[1])}]=]
  [=[{angle_of(sides[0])}]=])
mutant("a sliver of a sliding length" statics/all_equilibria/private/box_prover.cpp
  [=[narrow(box, a.length, dot(a.direction, rest) / squared_norm(a.direction))]=]
  [=[narrow(box, a.length, dot(a.direction, rest) / squared_norm(a.direction) + Interval(1e-9))]=])
mutant("other lengths on the same arm left out" statics/all_equilibria/private/box_prover.cpp
  [=[if (b.length != a.length) rest -= box[b.length] * b.direction;]=]
  [=[]=])
mutant("a sliver of the ground" statics/all_equilibria/private/box_prover.cpp
  [=[!both.x.meet(along.x)]=]
  [=[!both.x.meet(along.x + Interval(1e-9))]=])
mutant("a sliver above the angle of a triangle" statics/all_equilibria/private/box_prover.cpp
  [=[const Interval beta = solvers::arc_cosine(cosine);]=]
  [=[Interval beta = solvers::arc_cosine(cosine);
    beta = Interval(beta.lower(), beta.upper() - 1e-9);]=])
mutant("a sliver below the angle of a triangle" statics/all_equilibria/private/box_prover.cpp
  [=[const Interval beta = solvers::arc_cosine(cosine);]=]
  [=[Interval beta = solvers::arc_cosine(cosine);
    beta = Interval(beta.lower() + 1e-9, beta.upper());]=])
mutant("a triangle on one side only" statics/all_equilibria/private/box_prover.cpp
  [=[{base + beta, base - beta}]=]
  [=[{base + beta}]=])
mutant("a triangle without the other arm" statics/all_equilibria/private/box_prover.cpp
  [=[(square_s + square_of - square_other)]=]
  [=[(square_s + square_of - square_of)]=])

mutant("the sum of a triangle at the middle of the drivers" statics/all_equilibria/private/box_prover.cpp
  [=[centered -= (box[drivers_[p]] - thin_[drivers_[p]]) * sum.others[p];]=]
  [=[]=])
mutant("a coordinate that follows without what is left of closure" statics/all_equilibria/private/box_prover.cpp
  [=[Interval to = thin_[i] + own[d];]=]
  [=[Interval to = thin_[i];]=])
mutant("a coordinate that follows at the middle of the drivers" statics/all_equilibria/private/box_prover.cpp
  [=[to += own[p] * (box[drivers_[p]] - thin_[drivers_[p]]);]=]
  [=[]=])
mutant("a middle that leaves its place" statics/all_equilibria/private/box_prover.cpp
  [=[own[d] += outside - thin_[i];]=]
  [=[]=])
mutant("a loop that follows without what others leave open" statics/all_equilibria/private/box_prover.cpp
  [=[by[drivers_.size()] = box[i] - thin_[i];]=]
  [=[by[drivers_.size()] = Interval(0);]=])
mutant("stops at the middle of other coordinates" statics/all_equilibria/private/box_prover.cpp
  [=[own -= jacobian_[other] * (box[j] - middle[j]);]=]
  [=[own -= Interval(0);]=])
mutant("a sliver of what a stop leaves" statics/all_equilibria/private/box_prover.cpp
  [=[if (!box[i].meet(middle[i] + own / jacobian_[e])) return false;]=]
  [=[if (!box[i].meet(middle[i] + own / jacobian_[e] + Interval(1e-9))) return false;]=])

# --- box_prover.cpp: rows, balance, Newton's operator ---------------------------------------------------------------

mutant("a sliver of a coordinate by its balance" statics/all_equilibria/private/box_prover.cpp
  [=[const Interval to = at[j] - force_[i] / tangent_[e];]=]
  [=[const Interval to = at[j] - force_[i] / tangent_[e] + Interval(1e-9);]=])
mutant("balance at the middle of the others" statics/all_equilibria/private/box_prover.cpp
  [=[at[j] = box[j];]=]
  [=[]=])
mutant("balance without reactions" statics/all_equilibria/private/box_prover.cpp
  [=[if (is_free_[i] == 0 || (way == 1]=]
  [=[if ((way == 1]=])
mutant("stiffness of following loads taken for symmetric" statics/all_equilibria/private/box_prover.cpp
  [=[(i == j || plain_.has_follower_loads())]=]
  [=[(i == j)]=])
mutant("a row without the width of the first coordinate" statics/all_equilibria/private/box_prover.cpp
  [=[if (i != own) sum += row[i] * (box[i] - middle[i]);]=]
  [=[if (i != own && i != 0) sum += row[i] * (box[i] - middle[i]);]=])
mutant("a row with the middle of its own factor" statics/all_equilibria/private/box_prover.cpp
  [=[middle[own] - sum / row[own]]=]
  [=[middle[own] - sum / Interval(row[own].middle())]=])
mutant("a row without what is left of closure" statics/all_equilibria/private/box_prover.cpp
  [=[add_product(sum, inverse_[static_cast<std::size_t>(l) * m_ + k], constraint_[rows_[l]] - Interval(bounds_[l]));]=]
  [=[]=])
mutant("reactions without the change of the rows" statics/all_equilibria/private/box_prover.cpp
  [=[next -= error[static_cast<std::size_t>(i) * m_ + l] * y[i];]=]
  [=[]=])
mutant("reactions of a half of their bounds" statics/all_equilibria/private/box_prover.cpp
  [=[y[l] = Interval(-u[l], u[l]);]=]
  [=[y[l] = Interval(-0.5 * u[l], 0.5 * u[l]);]=])
mutant("motions of a half of their bounds" statics/all_equilibria/private/box_prover.cpp
  [=[x[k] = Interval(-u[k], u[k]);]=]
  [=[x[k] = Interval(-0.5 * u[k], 0.5 * u[k]);]=])
mutant("more stops than freedoms are forgotten in singular poses" statics/all_equilibria/private/box_prover.cpp
  [=[(most < small_pivot && !may_touch)]=]
  [=[(most < small_pivot)]=])
mutant("motions without the change of the rows" statics/all_equilibria/private/box_prover.cpp
  [=[next -= product_[static_cast<std::size_t>(k) * n_ + dependent_[l]] * x[l];]=]
  [=[]=])
mutant("rounds without what springs wind up" statics/all_equilibria/private/box_prover.cpp
  [=[change += motion * winding.change[i];]=]
  [=[change += motion * Interval(0.9) * winding.change[i];]=])
mutant("one round too few above" statics/all_equilibria/private/box_prover.cpp
  [=[std::floor(rounds.upper())]=]
  [=[std::ceil(rounds.upper()) - 1]=])
mutant("one round too few below" statics/all_equilibria/private/box_prover.cpp
  [=[std::ceil(rounds.lower())]=]
  [=[std::floor(rounds.lower()) + 1]=])
mutant("second order without reactions" statics/all_equilibria/private/box_prover.cpp
  [=[multipliers_[rows_[k]] = Interval(y[k].middle());]=]
  [=[multipliers_[rows_[k]] = Interval(0);]=])
mutant("second order without half of the stiffness" statics/all_equilibria/private/box_prover.cpp
  [=[if (i != j && !plain_.has_follower_loads()) add_product(row[i], t(j), tangent_[e]);]=]
  [=[]=])
mutant("second order with a motion that is none" statics/all_equilibria/private/box_prover.cpp
  [=[sum += slip * (y[k] - Interval(y[k].middle()));]=]
  [=[]=])
mutant("second order without what is left of closure" statics/all_equilibria/private/box_prover.cpp
  [=[sum += row[i] * motion_[static_cast<std::size_t>(i) * (d + 1) + d];]=]
  [=[]=])
mutant("second order at the middle of other freedoms" statics/all_equilibria/private/box_prover.cpp
  [=[if (other != p) rest += by[other] * (box[columns[other]] - thin[columns[other]]);]=]
  [=[]=])
mutant("second order refuses at the middle of its own freedom" statics/all_equilibria/private/box_prover.cpp
  [=[rest += by[p] * (box[own] - thin[own]);]=]
  [=[]=])
mutant("a sliver of a freedom" statics/all_equilibria/private/box_prover.cpp
  [=[if (!box[own].meet(thin[own] - rest / by[p])) return false;]=]
  [=[if (!box[own].meet(thin[own] - rest / by[p] + Interval(1e-9))) return false;]=])
mutant("dependent coordinates without what is left of closure" statics/all_equilibria/private/box_prover.cpp
  [=[Interval to = thin[i] + motion_[i * (d + 1) + d];]=]
  [=[Interval to = thin[i];]=])
mutant("shooting with the stiffness of the middle" statics/all_equilibria/private/box_prover.cpp
  [=[const Interval& own = stiffness_[step.row * n + step.gives];]=]
  [=[const Interval own(stiffness_[step.row * n + step.gives].middle());]=])
mutant("shooting without what is left of balance" statics/all_equilibria/private/box_prover.cpp
  [=[by[d] = force_[row];]=]
  [=[]=])
mutant("Newton's operator in a part of the box" statics/all_equilibria/private/newton_operator.cpp
  [=[reach_[i] = 1.1 * half + 1e-12;]=]
  [=[reach_[i] = 0.1 * half + 1e-12;]=])
mutant("Newton's operator with the error of the middle only" statics/all_equilibria/private/newton_operator.cpp
  [=[= row_[j].magnitude();]=]
  [=[= std::abs(row_[j].middle());]=])
mutant("Newton's operator without the symmetric stiffness" statics/all_equilibria/private/newton_operator.cpp
  [=[if (i != j && !plain_.has_follower_loads()) entry(j, i) += tangent_[e];]=]
  [=[]=])
mutant("Newton's operator need not be a contraction" statics/all_equilibria/private/newton_operator.cpp
  [=[if (!(ratio < 1)) return false;]=]
  [=[]=])
mutant("what leaves the box exists" statics/all_equilibria/private/newton_operator.cpp
  [=[within = within && u_[i] < reach_[i];]=]
  [=[within = true;]=])
mutant("stops are passed at the upper limit" statics/all_equilibria/private/box_prover.cpp
  [=[      if (measure > Interval(plain_.upper()[s]) || measure < Interval(plain_.lower()[s])) return false;]=]
  [=[      if (measure > Interval(plain_.lower()[s])) return false;]=])
mutant("rows that others imply need not close" statics/all_equilibria/private/box_prover.cpp
  [=[if (gap > Interval(open_gap) || gap < Interval(-open_gap)) return false;]=]
  [=[]=])
mutant("stops press outwards" statics/all_equilibria/private/box_prover.cpp
  [=[StopState::at_upper ? push < Interval(0) : push > Interval(0)]=]
  [=[StopState::at_upper ? push > Interval(0) : push < Interval(0)]=])

# --- enclosed_set.cpp: boxes and cases ------------------------------------------------------------------------------

mutant("a gap between halves" statics/all_equilibria/private/box_prover.cpp
  [=[upper[split] = Interval(split_at, upper[split].upper());]=]
  [=[upper[split] = Interval(split_at + 1e-6, upper[split].upper());]=])
mutant("less than a full turn" statics/all_equilibria/private/enclosed_set.cpp
  [=[constexpr double half_turn = 3.1416;]=]
  [=[constexpr double half_turn = 3.1415;]=])
mutant("a round between halves is lost" statics/all_equilibria/private/enclosed_set.cpp
  [=[other.rounds = Interval(middle + 1, other.rounds.upper());]=]
  [=[other.rounds = Interval(middle + 2, other.rounds.upper());]=])
mutant("boxes set aside are forgotten" statics/all_equilibria/private/enclosed_set.cpp
  [=[std::move(chunk.left.begin(), chunk.left.end(), std::back_inserter(left_));]=]
  [=[]=])
mutant("boxes that were not reached are forgotten" statics/all_equilibria/private/enclosed_set.cpp
  [=[for (std::vector<Task>* others : {&waiting_, &crossings_}) {]=]
  [=[for (std::vector<Task>* others : {&crossings_}) {]=])
mutant("change points are forgotten" statics/all_equilibria/private/enclosed_set.cpp
  [=[for (std::vector<Task>* others : {&waiting_, &crossings_}) {]=]
  [=[for (std::vector<Task>* others : {&waiting_}) {]=])
mutant("no case of the lower limit of a stop" statics/all_equilibria/private/enclosed_set.cpp
  [=[if (std::isfinite(lower)) states.push_back(StopState::at_lower);]=]
  [=[]=])
mutant("no case of the upper limit of a stop" statics/all_equilibria/private/enclosed_set.cpp
  [=[if (std::isfinite(upper)) states.push_back(StopState::at_upper);]=]
  [=[]=])
mutant("one stop too few at a time" statics/all_equilibria/private/enclosed_set.cpp
  [=[if (active >= freedoms && (state]=]
  [=[if (active + 1 >= freedoms && (state]=])
mutant("springs wind up less on the other side" statics/all_equilibria/private/enclosed_set.cpp
  [=[if (i != j) out.change[j] += springs.stiffness[e] * by[i];]=]
  [=[]=])
mutant("angles bounded though a stop on something else presses" statics/all_equilibria/private/open_angles.cpp
  [=[if (!is_on_angle(s)) return false;]=]
  [=[if (!is_on_angle(s)) continue;]=])
mutant("angles bounded without the springs' own force" statics/all_equilibria/private/open_angles.cpp
  [=[b[i] -= force[coordinate] + springs_->at_zero[coordinate];]=]
  [=[b[i] -= force[coordinate];]=])
mutant("angles bounded without other forces" statics/all_equilibria/private/open_angles.cpp
  [=[b[i] -= force[coordinate] + springs_->at_zero[coordinate];]=]
  [=[b[i] -= springs_->at_zero[coordinate];]=])
mutant("angles bounded without half of the stiffness" statics/all_equilibria/private/open_angles.cpp
  [=[if (i != j && place(j) < angles) add(place(j), i, springs_->stiffness[e]);]=]
  [=[]=])
mutant("angles bounded without the force of a stop" statics/all_equilibria/private/open_angles.cpp
  [=[if (place(column) < angles) a[place(column) * size + angles + k] += value;]=]
  [=[]=])
mutant("bounds of angles of the last case of stops" statics/all_equilibria/private/open_angles.cpp
  [=[one[i] = hull(one[i], (*all)[i]);]=]
  [=[]=])
mutant("limits of stops taken from the zero of another pose" statics/all_equilibria/private/open_angles.cpp
  [=[(limits - at_zero_[static_cast<std::size_t>(mechanism_.stop_row(s))])]=]
  [=[limits]=])
mutant("one round too few" statics/all_equilibria/private/enclosed_set.cpp
  [=[round <= range.rounds; ++round)]=]
  [=[round < range.rounds; ++round)]=])
mutant("no rounds below" statics/all_equilibria/private/enclosed_set.cpp
  [=[Interval(-range.rounds, range.rounds)]=]
  [=[Interval(0, range.rounds)]=])
mutant("turns without the step between their poses" statics/all_equilibria/private/enclosed_set.cpp
  [=[Interval(range.lower[i] - LoopTurns::step, range.upper[i] + LoopTurns::step)]=]
  [=[Interval(range.lower[i] + LoopTurns::step, range.upper[i] - LoopTurns::step)]=])

# --- loop_turns.cpp: turns that motion leads to ---------------------------------------------------------------------

mutant("turns of another assembly mode as they are met" statics/all_equilibria/private/loop_turns.cpp
  [=[for (std::size_t i = 0; i < x.size(); ++i) shift[i] = least[i] - pose[i];]=]
  [=[]=])
mutant("torques tell turns" statics/all_equilibria/private/loop_turns.cpp
  [=[springs.torques.clear();]=]
  [=[]=])
mutant("stops do not tell turns" statics/all_equilibria/private/loop_turns.cpp
  [=[out += stiffness_of_stops * passed * passed;]=]
  [=[]=])
mutant("angles are turned one at a time" statics/all_equilibria/private/loop_turns.cpp
  [=[if (j != i) other[j] += by;]=]
  [=[]=])
mutant("long steps near singular poses" statics/all_equilibria/private/loop_turns.cpp
  [=[if (is_singular(at, 2.0 * h)) continue;]=]
  [=[]=])
mutant("curves that are not followed to their ends are known" statics/all_equilibria/private/loop_turns.cpp
  [=[is_certain_ = is_certain_ && ends;]=]
  [=[static_cast<void>(ends);]=])
mutant("no body makes full turns" statics/all_equilibria/private/loop_turns.cpp
  [=[out.period[i] = 2.0 * M_PI * std::round((at[i] - x[i]) / (2.0 * M_PI));]=]
  [=[]=])
mutant("the curve ends where it starts" statics/all_equilibria/private/loop_turns.cpp
  [=[range.upper[i] = std::max(range.upper[i], pose[i]);]=]
  [=[]=])
mutant("rounds in one direction only" statics/all_equilibria/private/loop_turns.cpp
  [=[for (int rounds = -most_rounds; rounds <= most_rounds; ++rounds) {]=]
  [=[for (int rounds = 0; rounds <= most_rounds; ++rounds) {]=])

# --- assembly_modes.cpp ---------------------------------------------------------------------------------------------

mutant("modes that are found are not followed" statics/all_equilibria/private/assembly_modes.cpp
  [=[if (is_inside) loops.add(pose);]=]
  [=[]=])
mutant("a known curve passes through every box" statics/all_equilibria/private/assembly_modes.cpp
  [=[if (loops.passes(lower_corner(box), upper_corner(box))) return true;]=]
  [=[if (loops.passes(lower_corner(box), upper_corner(box)) || true) return true;]=])
mutant("poses of half of the boxes" statics/all_equilibria/private/assembly_modes.cpp
  [=[    waiting.push_back(std::move(other));
]=]
  [=[]=])
mutant("rigid poses are left out" statics/all_equilibria/private/assembly_modes.cpp
  [=[if (is_new) out.poses.push_back(pose);]=]
  [=[]=])

# --- crossing_branches.cpp: around change points --------------------------------------------------------------------

mutant("a change point is taken for a pose that needs unbounded forces" statics/all_equilibria/private/box_prover.cpp
  [=[region->joint_force > least_joint_force && !may_touch_stops(box);]=]
  [=[!may_touch_stops(box);]=])
mutant("the region around a change point has no end" statics/all_equilibria/private/crossing_branches.cpp
  [=[return abs(box[k] - Interval(at[k])) <= Interval(reach);]=]
  [=[return box[k].bounded();]=])
mutant("branches of any direction bear any force" statics/all_equilibria/private/crossing_branches.cpp
  [=[if (!eliminate(columns, c, done)) return false;]=]
  [=[if (!eliminate(columns, c, done)) return true;]=])
mutant("directions without branches are not told from others" statics/all_equilibria/private/crossing_branches.cpp
  [=[if (sum.excludes_zero()) return true;]=]
  [=[if (!sum.excludes_zero()) return true;]=])
