#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

namespace poise {

/// An XML file whose places are known. Entities and documents of elsewhere are not read.
class Xml {
 public:
  /// Throws InputError where the text is no XML, or deeper or larger than anybody writes.
  Xml(std::string_view text, std::string file);

  const std::string& file() const { return file_; }
  /// The outermost element. Throws InputError unless it has this name.
  pugi::xml_node root(const std::string& name) const;
  int line_of(pugi::xml_node node) const;

  /// Throws InputError with file and line of an element.
  [[noreturn]] void fail(pugi::xml_node node, const std::string& item, const std::string& message) const;
  /// An attribute as a number, or what it is where it is left out. Throws InputError.
  double number(pugi::xml_node node, const char* attribute, const std::string& item, double otherwise) const;
  /// The same of one that is required.
  double number(pugi::xml_node node, const char* attribute, const std::string& item) const;
  /// An attribute as a word that is not empty. Throws InputError where there is none.
  std::string word(pugi::xml_node node, const char* attribute, const std::string& item) const;
  /// An attribute with so many numbers, blanks between them; `otherwise` where it is left out. Throws InputError.
  std::vector<double> numbers(pugi::xml_node node, const char* attribute, const std::string& item, std::size_t count,
                              std::vector<double> otherwise) const;
  /// An attribute with `least` to `most` numbers, none where it is left out. Throws InputError.
  std::vector<double> numbers_up_to(pugi::xml_node node, const char* attribute, const std::string& item,
                                    std::size_t least, std::size_t most) const;

 private:
  std::string file_;
  pugi::xml_document document_;
  std::vector<std::size_t> line_begins_;
};

/// A text as the value of an attribute: characters that XML gives a meaning are entities.
std::string xml_value(std::string_view text);

}  // namespace poise
