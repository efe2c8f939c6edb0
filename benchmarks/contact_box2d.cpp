// Box2D 2.4: single precision, fixed steps, impulses by sequential iterations.

#include <cmath>

#include <box2d/box2d.h>
#include <fmt/format.h>

#include "benchmarks/contact_work.hpp"

namespace poise::benchmarks {
namespace {

// Box2D's units in a metre: it lets contacts overlap by 0.005 of them, which with one unit a metre is its largest
// error.
constexpr double units = 100.0;

struct Box2dSetting {
  int steps_per_second = 60;
  bool continuous = true;  // whether a step stops where a contact begins
  int iterations = 8;
};

class Box2dMotion : public ContactMotion {
 public:
  Box2dMotion(const ContactProblem& problem, const Box2dSetting& setting) : problem_(problem), setting_(setting) {}

  void begin() override {
    world_ = std::make_unique<b2World>(b2Vec2(0.0F, length(-gravity)));
    world_->SetContinuousPhysics(setting_.continuous);
    const b2BodyDef still;
    ground_ = world_->CreateBody(&still);
    if (problem_.scene == ContactScene::ball) make_ball();
    if (problem_.scene == ContactScene::block) make_block();
    if (problem_.scene == ContactScene::toggle) make_toggle();
  }

  std::vector<ContactState> move() override {
    const float step = 1.0F / static_cast<float>(setting_.steps_per_second);
    std::vector<ContactState> out;
    long made = 0;
    for (double time : problem_.times) {
      for (const long end = std::lround(time * setting_.steps_per_second); made < end; ++made) {
        world_->Step(step, setting_.iterations, setting_.iterations);
      }
      out.push_back(state());
    }
    return out;
  }

 private:
  static float length(double metres) { return static_cast<float>(metres * units); }
  static b2Vec2 point(double x, double y) { return {length(x), length(y)}; }

  ContactState state() const {
    if (problem_.scene == ContactScene::ball) {
      return {read_->GetPosition().y / units, read_->GetLinearVelocity().y / units};
    }
    return {read_->GetAngle(), read_->GetAngularVelocity()};
  }

  // The body has 1 kg; its inertia is about its center.
  b2Body* make_body(const b2Vec2& at, double angle, const b2Vec2& center, double inertia) {
    b2BodyDef about;
    about.type = b2_dynamicBody;
    about.position = at;
    about.angle = static_cast<float>(angle);
    b2Body* const body = world_->CreateBody(&about);
    b2MassData mass;
    mass.mass = 1.0F;
    mass.center = center;
    mass.I = static_cast<float>(inertia * units * units) + b2Dot(center, center);
    body->SetMassData(&mass);
    return body;
  }

  void touch(b2Body* body, const b2Shape& shape, double restitution, double friction) const {
    b2FixtureDef about;
    about.shape = &shape;
    about.restitution = static_cast<float>(restitution);
    about.friction = static_cast<float>(friction);
    // Gravity alone gives a body that rests this speed in two steps: slower ones do not rebound, or it never rests.
    about.restitutionThreshold = 2 * length(gravity) / static_cast<float>(setting_.steps_per_second);
    body->CreateFixture(&about);
  }

  // Shapes have skins of b2_polygonRadius, which touch before their outlines do; `skins` is all of them. The floor is a
  // body of its own, since bodies that a joint connects do not touch.
  void make_floor(double height, float skins, double friction) const {
    b2EdgeShape floor;
    const float y = length(height) - skins;
    floor.SetTwoSided({length(-10.0), y}, {length(10.0), y});
    b2FixtureDef about;
    about.shape = &floor;
    about.friction = static_cast<float>(friction);
    about.restitutionThreshold = b2_maxFloat;  // the lower one of both counts
    const b2BodyDef still;
    world_->CreateBody(&still)->CreateFixture(&about);
  }

  void make_ball() {
    const BallSizes sizes;
    b2CircleShape circle;
    circle.m_radius = length(0.1);
    read_ = make_body(point(0.0, sizes.height), 0.0, {0.0F, 0.0F}, 0.1);
    touch(read_, circle, sizes.restitution, 0.0);
    make_floor(-0.1, b2_polygonRadius, 0.0);
  }

  void make_block() {
    const BlockSizes sizes;
    b2PolygonShape box;
    box.SetAsBox(length(sizes.half_width), length(sizes.half_height));
    read_ = make_body(point(sizes.x(), sizes.y()), sizes.angle(), {0.0F, 0.0F}, sizes.inertia());
    touch(read_, box, 0.0, sizes.friction);
    make_floor(0.0, 2 * b2_polygonRadius, sizes.friction);
  }

  // A limit of a joint has no restitution in Box2D, so that the elbow falls on a floor at its height.
  void make_toggle() {
    const ToggleSizes sizes;
    const double x = std::cos(sizes.from), y = std::sin(sizes.from), radius = 0.05;
    b2Body* const crank = read_ = make_body({0.0F, 0.0F}, sizes.from, point(0.5, 0.0), sizes.inertia());
    b2Body* const rod = make_body(point(x, y), -sizes.from, point(0.5, 0.0), sizes.inertia());
    b2Body* const ram = make_body(point(2 * x, 0.0), 0.0, {0.0F, 0.0F}, 0.1);
    b2RevoluteJointDef pin;
    pin.Initialize(ground_, crank, {0.0F, 0.0F});
    world_->CreateJoint(&pin);
    pin.Initialize(crank, rod, point(x, y));
    world_->CreateJoint(&pin);
    pin.Initialize(rod, ram, point(2 * x, 0.0));
    world_->CreateJoint(&pin);
    b2PrismaticJointDef rail;
    rail.Initialize(ground_, ram, {0.0F, 0.0F}, {1.0F, 0.0F});
    world_->CreateJoint(&rail);
    b2CircleShape elbow;
    elbow.m_radius = length(radius);
    elbow.m_p = point(1.0, 0.0);
    touch(crank, elbow, sizes.restitution, 0.0);
    make_floor(std::sin(sizes.stop) - radius, b2_polygonRadius, 0.0);
  }

  ContactProblem problem_;
  Box2dSetting setting_;
  std::unique_ptr<b2World> world_;
  b2Body* ground_ = nullptr;
  b2Body* read_ = nullptr;
};

}  // namespace

std::vector<ContactSetting> box2d_settings(const ContactProblem& problem) {
  std::vector<ContactSetting> out;
  constexpr int coarsest = 60, finest = coarsest << 9;
  // A single body needs few iterations. The joints of the toggle need many: with 8, which Box2D recommends, it does not
  // rebound.
  const std::vector<int> iterations =
      problem.scene == ContactScene::toggle ? std::vector<int>{30, 100} : std::vector<int>{4};
  for (const bool continuous : {true, false}) {
    for (int many : iterations) {
      std::string name = continuous ? "Box2D, continuous" : "Box2D, discrete";
      if (iterations.size() > 1) name += fmt::format(", {} it.", many);
      for (int rate = coarsest; rate <= finest; rate *= 2) {
        const Box2dSetting setting{rate, continuous, many};
        out.push_back(
            {name, fmt::format("{} Hz", rate), [=] { return std::make_unique<Box2dMotion>(problem, setting); }});
      }
    }
  }
  return out;
}

}  // namespace poise::benchmarks
