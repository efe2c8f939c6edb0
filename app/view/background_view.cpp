#include "app/view/background_view.hpp"

#include <new>
#include <utility>

namespace poise::app {

BackgroundView::BackgroundView(ViewedScene scene, const Listening& listening)
    : view_(std::make_unique<ServedView>(std::move(scene), listening, ends_)),
      address_(view_->address()),
      thread_([this] { serve(); }) {}

BackgroundView::~BackgroundView() { stop(); }

void BackgroundView::serve() {
  try {
    view_->run();
  } catch (const std::bad_alloc&) {
    // The page says that its program has ended; the rest of the program goes on.
  }
  runs_ = false;
}

void BackgroundView::stop() {
  ends_ = true;
  const std::lock_guard<std::mutex> lock(stopping_);
  if (thread_.joinable()) thread_.join();
  view_.reset();
}

}  // namespace poise::app
