#pragma once

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/browser.hpp"

namespace poise::page_tests {

/// From now on the page keeps the files that it hands to the browser, in `blobs`.
inline void keep_files(test::Browser& browser) {
  browser.run(
      "window.blobs = []; const make = URL.createObjectURL;"
      "URL.createObjectURL = (blob) => { window.blobs.push(blob); return make.call(URL, blob); };");
}

inline void wait_for_file(test::Browser& browser, int count) {
  ASSERT_TRUE(browser.wait_for("window.blobs.length === " + std::to_string(count))) << count;
}

/// The last file is a picture (PNG) of what is drawn, with two pixels for each of the window. `svg`: a CSS selector.
inline void expect_png(test::Browser& browser, const std::string& svg) {
  const nlohmann::json png = browser.run(
      "return createImageBitmap(window.blobs.at(-1)).then((image) => {"
      "  const svg = document.querySelector(arguments[0]);"
      "  const canvas = document.createElement('canvas'); canvas.width = image.width; canvas.height = image.height;"
      "  const context = canvas.getContext('2d'); context.drawImage(image, 0, 0);"
      "  const {data} = context.getImageData(0, 0, image.width, image.height);"
      "  const colours = new Set(); for (let k = 0; k < data.length; k += 4) colours.add(`${data[k]},${data[k + 1]}`);"
      "  return [image.width, image.height, svg.clientWidth, svg.clientHeight, colours.size];"
      "})",
      {svg});
  EXPECT_NEAR(png[0].get<double>(), 2 * png[2].get<double>(), 1.0);
  EXPECT_NEAR(png[1].get<double>(), 2 * png[3].get<double>(), 1.0);
  EXPECT_GT(png[4].get<int>(), 20);  // something is drawn on the paper
}

/// The last file begins as all films of this kind (WebM), and is more than a head.
inline void expect_film(test::Browser& browser) {
  const nlohmann::json film = browser.run(
      "return window.blobs.at(-1).arrayBuffer().then((all) => [...new Uint8Array(all)].slice(0, 4)"
      ".concat([all.byteLength]))");
  EXPECT_EQ(film[0], 0x1A);
  EXPECT_EQ(film[1], 0x45);
  EXPECT_EQ(film[2], 0xDF);
  EXPECT_EQ(film[3], 0xA3);
  EXPECT_GT(film[4].get<int>(), 1000);
}

}  // namespace poise::page_tests
