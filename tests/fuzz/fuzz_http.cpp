// What comes to the port of `poise view`: the head of a request is read the same however it comes in pieces.
#include "app/view/http_request.hpp"
#include "tests/fuzz/fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  using namespace poise;
  const std::string_view text = fuzz::text_of(bytes, count);
  const app::HttpHead whole = app::read_head(text);
  fuzz::expect(whole.length <= text.size(), "a head that is longer than what came");
  fuzz::expect(whole.request.body_length <= app::HttpRequest::largest_body, "a body that is too long");
  if (whole.length == 0) return 0;
  fuzz::expect(app::read_head(text.substr(0, whole.length - 1)).length == 0, "a head that ends before its end");
  const app::HttpHead alone = app::read_head(text.substr(0, whole.length));
  fuzz::expect(alone.length == whole.length && alone.refused == whole.refused, "a head that depends on what follows");
  return 0;
}
