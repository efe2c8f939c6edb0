#include "motion/equation_code.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "model/one_line.hpp"
#include "motion/private/written_program.hpp"

namespace poise {
namespace {

using Words = std::vector<std::pair<std::string, std::string>>;

/// The text with each $WORD$ replaced.
std::string filled(std::string text, const Words& words) {
  for (const auto& [word, by] : words) {
    const std::string marked = "$" + word + "$";
    for (std::size_t at = text.find(marked); at != std::string::npos; at = text.find(marked, at + by.size())) {
      text.replace(at, marked.size(), by);
    }
  }
  return text;
}

std::vector<int> dependent_of(const EquationsOfMotion& equations) {
  std::vector<int> out;
  for (int i = 0; i < equations.coordinates(); ++i) {
    const bool is_independent = std::binary_search(equations.independent.begin(), equations.independent.end(), i);
    if (!is_independent) out.push_back(i);
  }
  return out;
}

/// "0: crank, rad" for each coordinate, and which of them are z.
std::vector<std::string> coordinate_lines(const EquationsOfMotion& equations) {
  std::vector<std::string> out;
  for (int i = 0; i < equations.coordinates(); ++i) {
    const Coordinate& one = equations.layout.coordinates[static_cast<std::size_t>(i)];
    const auto z = std::find(equations.independent.begin(), equations.independent.end(), i);
    std::string line = fmt::format("q[{}]  {}, {}", i, one.name.empty() ? "(without a name)" : one_line(one.name),
                                   equations.is_length(i) ? "m" : "rad");
    if (one.origin != 0.0) line += fmt::format(", counted from {} m", one.origin);
    if (z != equations.independent.end()) line += fmt::format("; z[{}]", z - equations.independent.begin());
    out.push_back(std::move(line));
  }
  return out;
}

std::vector<std::string> row_lines(const EquationsOfMotion& equations) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < equations.row_names.size(); ++i) {
    out.push_back(fmt::format("g[{}]  {}", i, one_line(equations.row_names[i])));
  }
  return out;
}

/// Rows of loops are lengths, m, and so are those of drives and couplings that hold a length.
bool is_row_of_length(const EquationsOfMotion& equations, std::size_t row) {
  const std::size_t closing = 2 * equations.layout.closures.size();
  if (row < closing) return true;
  std::size_t drive = row - closing;
  const Scene& scene = equations.scene;
  if (drive < scene.drives.size()) return !scene.drives[drive].on.is_angle();
  drive -= scene.drives.size();
  for (const Stop& stop : scene.stops) {
    if (stop.holds() && drive-- == 0) return !stop.on.is_angle();
  }
  return false;
}

/// With commas between, and in lines that are short enough.
template <class Each, class Text>
std::string list_of(const Each& each, Text text) {
  constexpr std::size_t columns = 80;
  std::string out, line;
  for (const auto& one : each) {
    const std::string next = text(one);
    if (line.size() + next.size() > columns) {
      out += line + ",\n    ";
      line.clear();
    }
    line += (line.empty() ? "" : ", ") + next;
  }
  return out.empty() ? line : "\n    " + out + line;
}

std::string units_of_rows(const EquationsOfMotion& equations, CodeLanguage language) {
  std::vector<double> units;
  for (std::size_t row = 0; row < equations.row_names.size(); ++row) {
    units.push_back(is_row_of_length(equations, row) ? equations.scales.length : 1.0);
  }
  return list_of(units, [&](double unit) { return written_number(unit, language); });
}

std::string units_of_coordinates(const EquationsOfMotion& equations, CodeLanguage language) {
  std::vector<double> units;
  for (int i = 0; i < equations.coordinates(); ++i)
    units.push_back(equations.is_length(i) ? equations.scales.length : 1.0);
  return list_of(units, [&](double unit) { return written_number(unit, language); });
}

std::string numbers_in(const std::vector<int>& numbers) {
  return list_of(numbers, [](int one) { return std::to_string(one); });
}

/// What is left out, in one sentence each.
std::vector<std::string> remarks_of(const EquationsOfMotion& equations) {
  std::vector<std::string> stops;
  for (const Stop& stop : equations.scene.stops) {
    if (!stop.holds()) stops.push_back(one_line(stop.title()));
  }
  if (stops.empty()) return {};
  return {fmt::format("Left out, for they act at their limits only: {}.", fmt::join(stops, ", "))};
}

/// Lines of at most so many columns.
std::string wrapped(const std::string& sentence, const std::string& indent) {
  constexpr std::size_t columns = 100;
  std::string out, line;
  for (std::size_t begin = 0; begin < sentence.size();) {
    const std::size_t end = std::min(sentence.find(' ', begin), sentence.size());
    if (!line.empty() && indent.size() + line.size() + 1 + end - begin > columns) {
      out += indent + line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + sentence.substr(begin, end - begin);
    begin = end + 1;
  }
  return out + indent + line + "\n";
}

std::string indented(const std::vector<std::string>& lines, const std::string& indent) {
  std::string out;
  for (const std::string& line : lines) out += indent + line + "\n";
  return out;
}

/// What C and Python say of the scene: nothing in it may begin or end a comment or a text, or be a word to replace.
std::string harmless(std::string text) {
  for (const char* const mark : {"*/", "/*", "??"}) {
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark)) text[at + 1] = ' ';
  }
  for (char& one : text) {
    if (one == '\\' || one == '"') one = '\'';
    if (one == '$') one = ' ';
  }
  return text;
}

Words common_words(const EquationsOfMotion& equations, CodeLanguage language) {
  const std::vector<int> dependent = dependent_of(equations);
  const std::string indent = language == CodeLanguage::c ? " * " : "";
  const std::string list_indent = indent + (language == CodeLanguage::c ? "  " : "    ");
  const std::string between = language == CodeLanguage::c ? " *\n" : "\n";
  std::string others = between;
  if (equations.row_names.empty()) {
    others += indent + "All of them are independent.\n";
  } else {
    others += indent + "The others follow from z by the rows g(q, t) = 0 of loops, couplings and drives:\n" +
              indented(row_lines(equations), list_indent);
  }
  for (const std::string& remark : remarks_of(equations)) others += between + wrapped(remark, indent);
  const Scene& scene = equations.scene;
  return {{"TITLE", harmless(one_line(scene.title.empty() ? scene.file : scene.title))},
          {"FILE", harmless(one_line(scene.file))},
          {"F", std::to_string(equations.freedoms())},
          {"N", std::to_string(equations.coordinates())},
          {"R", std::to_string(equations.row_names.size())},
          {"D", std::to_string(dependent.size())},
          {"COORDINATES", harmless(indented(coordinate_lines(equations), list_indent))},
          {"OTHERS", harmless(others)},
          {"INDEPENDENT", numbers_in(equations.independent)},
          {"DEPENDENT", numbers_in(dependent)},
          {"USED", numbers_in(equations.rows)},
          {"UNITS_OF_ROWS", units_of_rows(equations, language)},
          {"UNITS", units_of_coordinates(equations, language)}};
}

// --- C --------------------------------------------------------------------------------------------------------------

constexpr const char* head_in_c = R"(/* $TITLE$
 * The equation of motion of $FILE$, written by poise equations.
 *
 *   D(z) z'' + h(z, w) + c(z) = Q(z, w, t),   w = z'
 *
 * D   inertia matrix: w^T D w / 2 is the kinetic energy, where no drive moves
 * h   forces of inertia at z'' = 0: Coriolis and centrifugal ones, and those of moving drives
 * c   forces of gravity and of what is elastic: dV/dz
 * Q   generalized forces of loads, dampers and friction
 *
 * All in SI units: rad, m, kg, s. z are $F$ of the $N$ coordinates q (angles of bodies from the world's
 * x axis, counter-clockwise, and travels of joints):
$COORDINATES$$OTHERS$ *
 * Each function returns a status, and without 0 its results have no meaning:
 *   0  done
 *   1  it cannot be assembled at z and t from the position given
 *   2  singular position: the other coordinates do not follow from z there, or in the position given
 *   3  no inertia: D is not positive definite (of $NAME$_accelerations alone)
 *
 * q is a position to start from and becomes the closed position at z and t: the one of the way of assembly of
 * q, to which it is led in steps; without status 0 it stays. Nothing is allocated or kept: calls of several threads do not meet.
 */
#include <math.h>

#define $NAME$_FREEDOMS $F$
#define $NAME$_COORDINATES $N$
#define $NAME$_ROWS $R$

/* A closed position to begin with. */
extern const double $NAME$_start[$NAME$_COORDINATES];

/* Closes the loops: q from z. */
int $NAME$_close(double t, const double z[$NAME$_FREEDOMS], double q[$NAME$_COORDINATES]);

/* The same, and the rates v of all coordinates. */
int $NAME$_rates(double t, const double z[$NAME$_FREEDOMS], const double w[$NAME$_FREEDOMS],
    double q[$NAME$_COORDINATES], double v[$NAME$_COORDINATES]);

/* The same as $NAME$_close, and the parts of the equation; D row by row. */
int $NAME$_terms(double t, const double z[$NAME$_FREEDOMS], const double w[$NAME$_FREEDOMS],
    double q[$NAME$_COORDINATES], double D[$NAME$_FREEDOMS * $NAME$_FREEDOMS], double h[$NAME$_FREEDOMS],
    double c[$NAME$_FREEDOMS], double Q[$NAME$_FREEDOMS]);

/* The same as $NAME$_close, and alpha = z'' = D^-1 (Q - h - c). */
int $NAME$_accelerations(double t, const double z[$NAME$_FREEDOMS], const double w[$NAME$_FREEDOMS],
    double q[$NAME$_COORDINATES], double alpha[$NAME$_FREEDOMS]);

/* The rows g at q and their Jacobian J = dg/dq, row by row; q stays. */
void $NAME$_constraints(double t, const double q[$NAME$_COORDINATES], double *g, double *J);

)";

// It is written where closures or drives join coordinates.
constexpr const char* closing_in_c = R"(#define $NAME$_DEPENDENT $D$

static const int $NAME$_z[] = {$INDEPENDENT$}, $NAME$_other[] = {$DEPENDENT$}, $NAME$_used[] = {$USED$};
/* Lengths are compared with angles by this size of the mechanism. */
static const double $NAME$_row_unit[] = {$UNITS_OF_ROWS$};
static const double $NAME$_unit[] = {$UNITS$};

/* What varies with t and q: the rows g, their derivatives by t, and by q. */
static void $NAME$_closing(double t, const double *q, double *g, double *g_t, double *J) {
  int i;
  (void)t;
  (void)q;
  for (i = 0; i < $NAME$_ROWS; ++i) g[i] = g_t[i] = 0.0;
  for (i = 0; i < $NAME$_ROWS * $NAME$_COORDINATES; ++i) J[i] = 0.0;
$CLOSING$}

void $NAME$_constraints(double t, const double q[$NAME$_COORDINATES], double *g, double *J) {
  double g_t[$NAME$_ROWS];
  $NAME$_closing(t, q, g, g_t, J);
}

static double $NAME$_entry(const double *J, int row, int column) {
  return J[row * $NAME$_COORDINATES + column] * $NAME$_unit[column] / $NAME$_row_unit[row];
}

/* Factors of J over the dependent coordinates, with exchanges of rows. Returns the smallest pivot over the
 * largest entry of its column, 0 of a singular matrix. */
static double $NAME$_factor(const double *J, double *a, int *swapped) {
  enum { n = $NAME$_DEPENDENT };
  double worst = 1.0, pivot;
  int i, j, k;
  for (i = 0; i < n; ++i) {
    for (j = 0; j < n; ++j) a[i * n + j] = $NAME$_entry(J, $NAME$_used[i], $NAME$_other[j]);
  }
  for (k = 0; k < n; ++k) {
    double largest = 0.0;
    int p = k;
    for (i = 0; i < n; ++i) {
      largest = fmax(largest, fabs(a[i * n + k]));
      if (i > k && fabs(a[i * n + k]) > fabs(a[p * n + k])) p = i;
    }
    swapped[k] = p;
    for (j = 0; j < n && p != k; ++j) {
      const double kept = a[k * n + j];
      a[k * n + j] = a[p * n + j];
      a[p * n + j] = kept;
    }
    pivot = a[k * n + k];
    if (!(fabs(pivot) > 0.0)) return 0.0;
    worst = fmin(worst, fabs(pivot) / largest);
    for (i = k + 1; i < n; ++i) {
      a[i * n + k] /= pivot;
      for (j = k + 1; j < n; ++j) a[i * n + j] -= a[i * n + k] * a[k * n + j];
    }
  }
  for (j = 0; j < n; ++j) {
    double used = 0.0, any = 0.0;
    for (i = 0; i < n; ++i) used = fmax(used, fabs($NAME$_entry(J, $NAME$_used[i], $NAME$_other[j])));
    for (i = 0; i < $NAME$_ROWS; ++i) any = fmax(any, fabs($NAME$_entry(J, i, $NAME$_other[j])));
    if (used < worst * any) worst = used / any;
  }
  return worst;
}

/* full = -(dependent part of J)^-1 rows for the dependent coordinates, 0 for the others. */
static void $NAME$_follow(const double *a, const int *swapped, const double *rows, double *full) {
  enum { n = $NAME$_DEPENDENT };
  double x[n];
  int i, j;
  for (i = 0; i < n; ++i) x[i] = -rows[$NAME$_used[i]] / $NAME$_row_unit[$NAME$_used[i]];
  for (i = 0; i < n; ++i) {
    const double kept = x[i];
    x[i] = x[swapped[i]];
    x[swapped[i]] = kept;
  }
  for (i = 1; i < n; ++i) {
    for (j = 0; j < i; ++j) x[i] -= a[i * n + j] * x[j];
  }
  for (i = n - 1; i >= 0; --i) {
    for (j = i + 1; j < n; ++j) x[i] -= a[i * n + j] * x[j];
    x[i] /= a[i * n + i];
  }
  for (i = 0; i < $NAME$_COORDINATES; ++i) full[i] = 0.0;
  for (i = 0; i < n; ++i) full[$NAME$_other[i]] = x[i] * $NAME$_unit[$NAME$_other[i]];
}

/* One step: q becomes the position at which only the part `left` of the gaps `first` is left, from a
 * prediction that has moved by at most `reach`. Corrections as large as that lead to another way of assembly. */
static int $NAME$_correct(double t, double *q, const double *first, double left, double reach) {
  const double fine = 2.220446049250313e-13;
  double g[$NAME$_ROWS], g_t[$NAME$_ROWS], J[$NAME$_ROWS * $NAME$_COORDINATES];
  double a[$NAME$_DEPENDENT * $NAME$_DEPENDENT], full[$NAME$_COORDINATES];
  double corrected = 0.0, last = 0.0;
  int swapped[$NAME$_DEPENDENT], i, iteration;
  for (iteration = 0; iteration < 12; ++iteration) {
    double gap = 0.0, step = 0.0, pivot;
    $NAME$_closing(t, q, g, g_t, J);
    pivot = $NAME$_factor(J, a, swapped);
    if (!(pivot > 1e-9)) return 0;
    for (i = 0; i < $NAME$_ROWS; ++i) g[i] -= left * first[i];
    for (i = 0; i < $NAME$_DEPENDENT; ++i) {
      gap = fmax(gap, fabs(g[$NAME$_used[i]]) / $NAME$_row_unit[$NAME$_used[i]]);
    }
    if (gap <= 7e-16) return 1;
    $NAME$_follow(a, swapped, g, full);
    for (i = 0; i < $NAME$_COORDINATES; ++i) step = fmax(step, fabs(full[i]) / $NAME$_unit[i]);
    corrected += step;
    if (!(step < 1.0) || corrected > reach / 2 + fine / pivot) return 0;
    for (i = 0; i < $NAME$_COORDINATES; ++i) q[i] += full[i];
    if (step <= fine || (iteration > 2 && step <= fine / pivot) || (iteration > 5 && step < 1e-9 && step >= last))
      return 1;
    last = step;
  }
  return 0;
}

/* Leads q to z in steps, and gives there the factors of J, B = dq/dz, and the derivatives of g by t. Where that
 * fails q stays. */
static int $NAME$_place(double t, const double *z, double *q, double *a, int *swapped, double *B, double *g_t) {
  const double least = 1.0 / 4096;
  double first[$NAME$_ROWS], g[$NAME$_ROWS], J[$NAME$_ROWS * $NAME$_COORDINATES];
  double full[$NAME$_COORDINATES], at[$NAME$_COORDINATES], next[$NAME$_COORDINATES], from[$NAME$_FREEDOMS];
  double way = 0.0, step = 1.0;
  int i, k, row;
  for (i = 0; i < $NAME$_COORDINATES; ++i) at[i] = q[i];
  for (k = 0; k < $NAME$_FREEDOMS; ++k) from[k] = q[$NAME$_z[k]];
  $NAME$_closing(t, q, first, g_t, J);
  while (way < 1.0) {
    double reach = 0.0;
    $NAME$_closing(t, at, g, g_t, J);
    if (!($NAME$_factor(J, a, swapped) > 1e-9)) return way > 0.0 ? 1 : 2;
    for (row = 0; row < $NAME$_ROWS; ++row) {
      g[row] = first[row];
      for (k = 0; k < $NAME$_FREEDOMS; ++k) g[row] += J[row * $NAME$_COORDINATES + $NAME$_z[k]] * (z[k] - from[k]);
    }
    $NAME$_follow(a, swapped, g, full);
    for (k = 0; k < $NAME$_FREEDOMS; ++k) full[$NAME$_z[k]] = z[k] - from[k];
    for (;;) {
      const double to = way + step;
      for (i = 0; i < $NAME$_COORDINATES; ++i) {
        next[i] = at[i] + step * full[i];
        reach = fmax(reach, fabs(step * full[i]) / $NAME$_unit[i]);
      }
      for (k = 0; k < $NAME$_FREEDOMS; ++k) next[$NAME$_z[k]] = to < 1.0 ? from[k] + to * (z[k] - from[k]) : z[k];
      if (reach < 1.0 && $NAME$_correct(t, next, first, 1.0 - to, reach)) break;
      step /= 2;
      reach = 0.0;
      if (!(step >= least)) return 1;
    }
    for (i = 0; i < $NAME$_COORDINATES; ++i) at[i] = next[i];
    way += step;
    step = fmin(2 * step, 1.0 - way);
  }
  $NAME$_closing(t, at, g, g_t, J);
  if (!($NAME$_factor(J, a, swapped) > 1e-9)) return 2;
  for (i = 0; i < $NAME$_COORDINATES; ++i) q[i] = at[i];
  for (k = 0; k < $NAME$_FREEDOMS; ++k) {
    for (row = 0; row < $NAME$_ROWS; ++row) g[row] = J[row * $NAME$_COORDINATES + $NAME$_z[k]];
    $NAME$_follow(a, swapped, g, full);
    full[$NAME$_z[k]] = 1.0;
    for (i = 0; i < $NAME$_COORDINATES; ++i) B[i * $NAME$_FREEDOMS + k] = full[i];
  }
  return 0;
}
)";

// It is written where all coordinates are independent.
constexpr const char* open_in_c = R"(#define $NAME$_DEPENDENT 1

static const int $NAME$_z[] = {$INDEPENDENT$};

void $NAME$_constraints(double t, const double q[$NAME$_COORDINATES], double *g, double *J) {
  (void)t;
  (void)q;
  (void)g;
  (void)J;
}

/* Nothing has to be closed: all coordinates are independent. */
static void $NAME$_follow(const double *a, const int *swapped, const double *rows, double *full) {
  int i;
  (void)a;
  (void)swapped;
  (void)rows;
  for (i = 0; i < $NAME$_COORDINATES; ++i) full[i] = 0.0;
}

static int $NAME$_place(double t, const double *z, double *q, double *a, int *swapped, double *B, double *g_t) {
  int i, k;
  (void)t;
  a[0] = 1.0;
  swapped[0] = 0;
  g_t[0] = 0.0;
  for (k = 0; k < $NAME$_FREEDOMS; ++k) q[$NAME$_z[k]] = z[k];
  for (i = 0; i < $NAME$_COORDINATES; ++i) {
    for (k = 0; k < $NAME$_FREEDOMS; ++k) B[i * $NAME$_FREEDOMS + k] = $NAME$_z[k] == i ? 1.0 : 0.0;
  }
  return 0;
}
)";

constexpr const char* rest_in_c = R"(
/* In all coordinates with the rates v: inertia M, forces of inertia k without accelerations, dV/dq, loads, and
 * the second derivatives of the rows by time without accelerations. */
static void $NAME$_forces(double t, const double *q, const double *v, double *M, double *k, double *V_q,
    double *Q_q, double *b) {
  int i;
  (void)t;
  (void)q;
  (void)v;
  for (i = 0; i < $NAME$_COORDINATES * $NAME$_COORDINATES; ++i) M[i] = 0.0;
  for (i = 0; i < $NAME$_COORDINATES; ++i) k[i] = V_q[i] = Q_q[i] = 0.0;
  for (i = 0; i < $B_ROWS$; ++i) b[i] = 0.0;
$FORCES$}

const double $NAME$_start[$NAME$_COORDINATES] = {$START$};

int $NAME$_close(double t, const double z[$NAME$_FREEDOMS], double q[$NAME$_COORDINATES]) {
  double a[$NAME$_DEPENDENT * $NAME$_DEPENDENT], B[$NAME$_COORDINATES * $NAME$_FREEDOMS], g_t[$B_ROWS$];
  int swapped[$NAME$_DEPENDENT];
  return $NAME$_place(t, z, q, a, swapped, B, g_t);
}

int $NAME$_rates(double t, const double z[$NAME$_FREEDOMS], const double w[$NAME$_FREEDOMS],
    double q[$NAME$_COORDINATES], double v[$NAME$_COORDINATES]) {
  double a[$NAME$_DEPENDENT * $NAME$_DEPENDENT], B[$NAME$_COORDINATES * $NAME$_FREEDOMS], g_t[$B_ROWS$];
  int swapped[$NAME$_DEPENDENT], i, j;
  const int status = $NAME$_place(t, z, q, a, swapped, B, g_t);
  if (status != 0) return status;
  $NAME$_follow(a, swapped, g_t, v);
  for (i = 0; i < $NAME$_COORDINATES; ++i) {
    for (j = 0; j < $NAME$_FREEDOMS; ++j) v[i] += B[i * $NAME$_FREEDOMS + j] * w[j];
  }
  return 0;
}

int $NAME$_terms(double t, const double z[$NAME$_FREEDOMS], const double w[$NAME$_FREEDOMS],
    double q[$NAME$_COORDINATES], double D[$NAME$_FREEDOMS * $NAME$_FREEDOMS], double h[$NAME$_FREEDOMS],
    double c[$NAME$_FREEDOMS], double Q[$NAME$_FREEDOMS]) {
  double a[$NAME$_DEPENDENT * $NAME$_DEPENDENT], B[$NAME$_COORDINATES * $NAME$_FREEDOMS], g_t[$B_ROWS$];
  double M[$NAME$_COORDINATES * $NAME$_COORDINATES], v[$NAME$_COORDINATES], free_a[$NAME$_COORDINATES];
  double k[$NAME$_COORDINATES], V_q[$NAME$_COORDINATES], Q_q[$NAME$_COORDINATES], b[$B_ROWS$];
  int swapped[$NAME$_DEPENDENT], i, j, m;
  const int status = $NAME$_place(t, z, q, a, swapped, B, g_t);
  if (status != 0) return status;
  $NAME$_follow(a, swapped, g_t, v);
  for (i = 0; i < $NAME$_COORDINATES; ++i) {
    for (j = 0; j < $NAME$_FREEDOMS; ++j) v[i] += B[i * $NAME$_FREEDOMS + j] * w[j];
  }
  $NAME$_forces(t, q, v, M, k, V_q, Q_q, b);
  $NAME$_follow(a, swapped, b, free_a);
  for (i = 0; i < $NAME$_FREEDOMS * $NAME$_FREEDOMS; ++i) D[i] = 0.0;
  for (j = 0; j < $NAME$_FREEDOMS; ++j) h[j] = c[j] = Q[j] = 0.0;
  for (i = 0; i < $NAME$_COORDINATES; ++i) {
    for (m = 0; m < $NAME$_COORDINATES; ++m) k[i] += M[i * $NAME$_COORDINATES + m] * free_a[m];
    for (j = 0; j < $NAME$_FREEDOMS; ++j) {
      const double B_ij = B[i * $NAME$_FREEDOMS + j];
      h[j] += B_ij * k[i];
      c[j] += B_ij * V_q[i];
      Q[j] += B_ij * Q_q[i];
    }
    for (j = 0; j < $NAME$_FREEDOMS; ++j) {
      double moved = 0.0;
      for (m = 0; m < $NAME$_COORDINATES; ++m) {
        moved += M[i * $NAME$_COORDINATES + m] * B[m * $NAME$_FREEDOMS + j];
      }
      for (m = 0; m < $NAME$_FREEDOMS; ++m) D[m * $NAME$_FREEDOMS + j] += B[i * $NAME$_FREEDOMS + m] * moved;
    }
  }
  return 0;
}

int $NAME$_accelerations(double t, const double z[$NAME$_FREEDOMS], const double w[$NAME$_FREEDOMS],
    double q[$NAME$_COORDINATES], double alpha[$NAME$_FREEDOMS]) {
  enum { n = $NAME$_FREEDOMS };
  double L[n * n], h[n], c[n], Q[n];
  int i, j, m;
  const int status = $NAME$_terms(t, z, w, q, L, h, c, Q);
  if (status != 0) return status;
  /* L L^T = D. */
  for (j = 0; j < n; ++j) {
    for (i = j; i < n; ++i) {
      const double whole = L[i * n + j];
      double left = whole;
      for (m = 0; m < j; ++m) left -= L[i * n + m] * L[j * n + m];
      if (i == j && (!(left > 1e-13 * whole) || !(whole > 0.0))) return 3;
      L[i * n + j] = i == j ? sqrt(left) : left / L[j * n + j];
    }
  }
  for (i = 0; i < n; ++i) {
    alpha[i] = Q[i] - h[i] - c[i];
    for (m = 0; m < i; ++m) alpha[i] -= L[i * n + m] * alpha[m];
    alpha[i] /= L[i * n + i];
  }
  for (i = n - 1; i >= 0; --i) {
    for (m = i + 1; m < n; ++m) alpha[i] -= L[m * n + i] * alpha[m];
    alpha[i] /= L[i * n + i];
  }
  return 0;
}
)";

// --- Python ---------------------------------------------------------------------------------------------------------

constexpr const char* whole_in_python = R"("""$TITLE$

The equation of motion of $FILE$, written by poise equations.

    D(z) z'' + h(z, w) + c(z) = Q(z, w, t),   w = z'

    D   inertia matrix: w^T D w / 2 is the kinetic energy, where no drive moves
    h   forces of inertia at z'' = 0: Coriolis and centrifugal ones, and those of moving drives
    c   forces of gravity and of what is elastic: dV/dz
    Q   generalized forces of loads, dampers and friction

All in SI units: rad, m, kg, s. z are $F$ of the $N$ coordinates q (angles of bodies from the world's x
axis, counter-clockwise, and travels of joints):
$COORDINATES$$OTHERS$
Each function returns a status first, and without OK its results have no meaning: CANNOT_BE_ASSEMBLED at z
and t from the position given, SINGULAR where the other coordinates do not follow from z, NO_INERTIA where D is
not positive definite (of accelerations() alone). The position q from which they start stays as it is; they
return the closed one at z and t of the same way of assembly, to which it is led in steps.
"""

import numpy as np

OK, CANNOT_BE_ASSEMBLED, SINGULAR, NO_INERTIA = 0, 1, 2, 3
FREEDOMS = $F$
COORDINATES = $N$
ROWS = $R$
# A closed position to begin with.
START = np.array([$START$])

_Z = np.array([$INDEPENDENT$], dtype=int)
_OTHER = np.array([$DEPENDENT$], dtype=int)
_USED = np.array([$USED$], dtype=int)
# Lengths are compared with angles by this size of the mechanism.
_ROW_UNIT = np.array([$UNITS_OF_ROWS$])
_UNIT = np.array([$UNITS$])
_LIMIT = 1e-9
_FINE = 2.220446049250313e-13
_LEAST = 1.0 / 4096


def close(t, z, q=START):
    """Closes the loops: (status, q)."""
    status, q, _ = _place(np.float64(t), np.asarray(z, dtype=float), q)
    return status, q


def rates(t, z, w, q=START):
    """(status, q, v), v the rates of all coordinates."""
    t, w = np.float64(t), np.asarray(w, dtype=float)
    status, q, there = _place(t, np.asarray(z, dtype=float), q)
    return status, q, None if there is None else _rates(there, w)


def terms(t, z, w, q=START):
    """(status, q, D, h, c, Q)."""
    t, w = np.float64(t), np.asarray(w, dtype=float)
    status, q, there = _place(t, np.asarray(z, dtype=float), q)
    if there is None:
        return status, q, None, None, None, None
    matrix, B, _ = there
    M, k, V_q, Q_q, b = _forces(t, q, _rates(there, w))
    M = M.reshape(COORDINATES, COORDINATES)
    return status, q, B.T @ M @ B, B.T @ (k + M @ _follow(matrix, b)), B.T @ V_q, B.T @ Q_q


def accelerations(t, z, w, q=START):
    """(status, q, alpha), alpha = z'' = D^-1 (Q - h - c)."""
    status, q, D, h, c, Q = terms(t, z, w, q)
    if status != OK:
        return status, q, None
    L = np.zeros((FREEDOMS, FREEDOMS))
    for j in range(FREEDOMS):
        for i in range(j, FREEDOMS):
            left = D[i, j] - L[i, :j] @ L[j, :j]
            if i == j and not (left > 1e-13 * D[i, i] > 0.0):
                return NO_INERTIA, q, None
            L[i, j] = np.sqrt(left) if i == j else left / L[j, j]
    return status, q, np.linalg.solve(L.T, np.linalg.solve(L, Q - h - c))


def constraints(t, q):
    """The rows g at q and their Jacobian J = dg/dq."""
    g, _, J = _closing(np.float64(t), np.asarray(q, dtype=float))
    return g, J.reshape(ROWS, COORDINATES)


def _rates(there, w):
    matrix, B, g_t = there
    return B @ w + _follow(matrix, g_t)


def _follow(matrix, rows):
    """What the dependent coordinates do so that J full = -rows, the others being still."""
    full = np.zeros(COORDINATES)
    if _OTHER.size > 0:
        full[_OTHER] = np.linalg.solve(matrix, -rows[_USED] / _ROW_UNIT[_USED]) * _UNIT[_OTHER]
    return full


def _pivot(scaled, matrix):
    """The smallest pivot of the dependent part of J over the largest entry of its column; 0: it is singular."""
    a, worst = matrix.copy(), 1.0
    for k in range(len(a)):
        largest = np.max(np.abs(a[:, k]))
        p = k + int(np.argmax(np.abs(a[k:, k])))
        a[[k, p]] = a[[p, k]]
        if not abs(a[k, k]) > 0.0:
            return 0.0
        worst = min(worst, abs(a[k, k]) / largest)
        a[k + 1:, k] /= a[k, k]
        a[k + 1:, k + 1:] -= np.outer(a[k + 1:, k], a[k, k + 1:])
    used = np.max(np.abs(matrix), axis=0)
    every = np.max(np.abs(scaled[:, _OTHER]), axis=0)
    few = used < worst * every
    return min(worst, float(np.min(used[few] / every[few]))) if few.any() else worst


def _closed(t, q):
    """g, g_t, J, its dependent part scaled, and the pivot of that."""
    g, g_t, J = _closing(t, q)
    J = J.reshape(ROWS, COORDINATES)
    scaled = J * _UNIT / _ROW_UNIT[:, None]
    matrix = scaled[np.ix_(_USED, _OTHER)]
    return g, g_t, J, matrix, _pivot(scaled, matrix) if _OTHER.size > 0 else 1.0


def _correct(t, q, first, left, reach):
    """The position at which only the part `left` of the gaps `first` is left, from a prediction that has moved by
    `reach`; None: corrections as large as that lead to another way of assembly."""
    corrected = last = 0.0
    for iteration in range(12):
        g, _, _, matrix, pivot = _closed(t, q)
        if not pivot > _LIMIT:
            return None
        g = g - left * first
        if np.max(np.abs(g[_USED]) / _ROW_UNIT[_USED], initial=0.0) <= 7e-16:
            return q
        full = _follow(matrix, g)
        step = float(np.max(np.abs(full) / _UNIT))
        corrected += step
        if not step < 1.0 or corrected > reach / 2 + _FINE / pivot:
            return None
        q = q + full
        if step <= _FINE or (iteration > 2 and step <= _FINE / pivot) or (iteration > 5 and 1e-9 > step >= last):
            return q
        last = step
    return None


def _place(t, z, q):
    """Leads q to z in steps: (status, q, (dependent part of J, B = dq/dz, g_t))."""
    given = q = np.array(q, dtype=float)
    start, way, step = q[_Z].copy(), 0.0, 1.0
    first = _closed(t, q)[0]
    while way < 1.0:
        _, _, J, matrix, pivot = _closed(t, q)
        if not pivot > _LIMIT:
            return CANNOT_BE_ASSEMBLED if way > 0.0 else SINGULAR, given, None
        full = _follow(matrix, first + J[:, _Z] @ (z - start))
        full[_Z] = z - start
        while True:
            to = way + step
            reach = float(np.max(np.abs(step * full) / _UNIT))
            moved = q + step * full
            moved[_Z] = start + to * (z - start) if to < 1.0 else z
            free = _OTHER.size == 0
            found = moved if free else _correct(t, moved, first, 1.0 - to, reach) if reach < 1.0 else None
            if found is not None:
                break
            step /= 2
            if not step >= _LEAST:
                return CANNOT_BE_ASSEMBLED, given, None
        q = found
        way += step
        step = min(2 * step, 1.0 - way)
    _, g_t, J, matrix, pivot = _closed(t, q)
    if not pivot > _LIMIT:
        return SINGULAR, given, None
    B = np.column_stack([_follow(matrix, J[:, z_k]) for z_k in _Z])
    B[_Z, np.arange(FREEDOMS)] = 1.0
    return OK, q, (matrix, B, g_t)


@np.errstate(all="ignore")
def _closing(t, q):
    g, g_t, J = np.zeros(ROWS), np.zeros(ROWS), np.zeros(ROWS * COORDINATES)
$CLOSING$    return g, g_t, J


@np.errstate(all="ignore")
def _forces(t, q, v):
    M, k, V_q = np.zeros(COORDINATES * COORDINATES), np.zeros(COORDINATES), np.zeros(COORDINATES)
    Q_q, b = np.zeros(COORDINATES), np.zeros(ROWS)
$FORCES$    return M, k, V_q, Q_q, b
)";

std::string start_of(const EquationsOfMotion& equations, CodeLanguage language) {
  return list_of(equations.begin, [&](double q) { return written_number(q, language); });
}

}  // namespace

std::string name_in_code(std::string_view file) {
  std::string name = std::filesystem::path(file).stem().string();
  for (char& one : name) {
    const auto letter = static_cast<unsigned char>(one);
    if (letter >= 128 || std::isalnum(letter) == 0) one = '_';
  }
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) != 0) name = "m_" + name;
  return name;
}

std::string c_code(const EquationsOfMotion& equations) {
  const EquationProgram program = record_equations(equations);
  Words words = common_words(equations, CodeLanguage::c);
  const bool is_open = equations.rows.empty();
  words.emplace_back("CLOSING", written_program(program.closing, CodeLanguage::c, "  "));
  words.emplace_back("FORCES", written_program(program.forces, CodeLanguage::c, "  "));
  words.emplace_back("B_ROWS", equations.row_names.empty() ? "1" : "$NAME$_ROWS");
  words.emplace_back("START", start_of(equations, CodeLanguage::c));
  words.emplace_back("NAME", name_in_code(equations.scene.file));
  return filled(std::string(head_in_c) + (is_open ? open_in_c : closing_in_c) + rest_in_c, words);
}

std::string python_code(const EquationsOfMotion& equations) {
  const EquationProgram program = record_equations(equations);
  Words words = common_words(equations, CodeLanguage::python);
  words.emplace_back("CLOSING", written_program(program.closing, CodeLanguage::python, "    "));
  words.emplace_back("FORCES", written_program(program.forces, CodeLanguage::python, "    "));
  words.emplace_back("START", start_of(equations, CodeLanguage::python));
  return filled(whole_in_python, words);
}

}  // namespace poise
