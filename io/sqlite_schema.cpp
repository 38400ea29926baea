// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/sqlite_schema.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "io/text.hpp"

// The B-tree of page 1 after https://www.sqlite.org/fileformat2.html.
namespace terrane {
namespace {

struct Damaged {};

class Database {
 public:
  explicit Database(std::string_view bytes) : bytes_(bytes) {
    if (bytes.size() < 512) throw Damaged();
    page_size_ = number(16, 2) == 1 ? 65536 : number(16, 2);
    usable_ = page_size_ - number(20, 1);
    if (page_size_ < 512 || usable_ < 480) throw Damaged();
    const std::uint64_t encoding = number(56, 4) & 3;
    if (encoding > 1) throw Damaged();
  }

  struct Entry {
    std::uint64_t root;
    std::string sql;
  };

  /// What has SQL: some things SQLite makes by itself.
  std::vector<Entry> schema() {
    std::vector<Entry> entries;
    for (const std::string& row : rows(1))
      if (std::optional<Entry> entry = entry_of(row)) entries.push_back(*std::move(entry));
    return entries;
  }

  /// Of the table whose first page this is.
  std::vector<std::string> rows(std::uint64_t root) {
    rows_.clear(), looked_at_ = 0;
    read_page(root, 0);
    return std::move(rows_);
  }

 private:
  std::uint64_t number(std::uint64_t at, int size) const {
    if (at + size > bytes_.size()) throw Damaged();
    std::uint64_t value = 0;
    for (int i = 0; i < size; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes_[at + i]);
    return value;
  }

  /// Where a page begins. A page is looked at once; more of them is a loop.
  std::uint64_t page(std::uint64_t index) {
    if (index == 0 || ++looked_at_ > bytes_.size() / page_size_ + 1) throw Damaged();
    return (index - 1) * page_size_;
  }

  static std::uint64_t varint(std::string_view& text) {
    std::uint64_t value = 0;
    for (int i = 0; i < 9; ++i) {
      if (text.empty()) throw Damaged();
      const auto byte = static_cast<std::uint8_t>(text.front());
      text.remove_prefix(1);
      if (i == 8) return value << 8 | byte;
      value = value << 7 | (byte & 0x7f);
      if (byte < 0x80) break;
    }
    return value;
  }

  void read_page(std::uint64_t index, int depth) {
    constexpr int deepest = 20;  // SQLite's limit
    if (depth > deepest) throw Damaged();
    const std::uint64_t begin = page(index), header = begin + (index == 1 ? 100 : 0), kind = number(header, 1);
    const std::uint64_t cells = number(header + 3, 2);
    if (kind != 5 && kind != 13) throw Damaged();
    for (std::uint64_t i = 0; i < cells; ++i) {
      const std::uint64_t cell = number(header + (kind == 5 ? 12 : 8) + 2 * i, 2);
      if (kind == 5)
        read_page(number(begin + cell, 4), depth + 1);
      else
        read_cell(begin, cell);
    }
    if (kind == 5) read_page(number(header + 8, 4), depth + 1);
  }

  void read_cell(std::uint64_t begin, std::uint64_t cell) {
    if (cell >= usable_ || begin + usable_ > bytes_.size()) throw Damaged();
    std::string_view local = bytes_.substr(begin + cell, usable_ - cell);
    const std::uint64_t size = varint(local);
    varint(local);  // the row's number
    const std::uint64_t most = usable_ - 35, least = (usable_ - 12) * 32 / 255 - 23;
    if (size > bytes_.size()) throw Damaged();
    std::uint64_t here = size;
    if (size > most) {
      here = least + (size - least) % (usable_ - 4);
      if (here > most) here = least;
    }
    if (local.size() < here) throw Damaged();
    std::string record(local.substr(0, here));
    if (here < size) {
      if (local.size() < here + 4) throw Damaged();
      add_overflow(record, static_cast<std::uint64_t>(local.data() + here - bytes_.data()), size);
    }
    rows_.push_back(std::move(record));
  }

  /// `at`: where the number of the next page stands.
  void add_overflow(std::string& record, std::uint64_t at, std::uint64_t size) {
    while (record.size() < size) {
      at = page(number(at, 4));
      const std::uint64_t count = std::min(size - record.size(), usable_ - 4);
      if (at + 4 + count > bytes_.size()) throw Damaged();
      record += bytes_.substr(at + 4, count);
    }
  }

  /// Of a row of the schema the fourth value is the page, the fifth the SQL.
  static std::optional<Entry> entry_of(std::string_view record) {
    constexpr std::uint64_t sizes[] = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0};
    std::string_view types = record;
    std::uint64_t at = varint(types), root = 0;
    for (int column = 0; column < 5; ++column) {
      const std::uint64_t type = varint(types);
      if (type == 10 || type == 11) throw Damaged();
      const std::uint64_t size = type < 10 ? sizes[type] : (type - 12) / 2;
      if (size > record.size() || at > record.size() - size) throw Damaged();
      const std::string_view value = record.substr(at, size);
      if (column == 3 && type < 7)
        for (const char c : value) root = root << 8 | static_cast<std::uint8_t>(c);
      if (column == 3 && type == 9) root = 1;
      if (column == 4 && type != 0) return Entry{root, std::string(value)};
      at += size;
    }
    return {};
  }

  std::string_view bytes_;
  std::uint64_t page_size_ = 0, usable_ = 0, looked_at_ = 0;
  std::vector<std::string> rows_;
};

/// The next word or mark of SQL in small letters; "" at the end. What is quoted comes as the quote alone.
class Tokens {
 public:
  explicit Tokens(std::string_view sql) : left_(sql) {}

  std::string next() {
    skip();
    if (left_.empty()) return "";
    const char first = left_.front();
    std::size_t size = 1;
    if (is_word(first)) {
      while (size < left_.size() && is_word(left_[size])) ++size;
    } else if (first == '\'' || first == '"' || first == '`' || first == '[') {
      const std::size_t end = left_.find(first == '[' ? ']' : first, 1);
      left_.remove_prefix(end == std::string_view::npos ? left_.size() : end + 1);
      return {first};
    }
    const std::string word = lower(left_.substr(0, size));
    left_.remove_prefix(size);
    return word;
  }

 private:
  static bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '$' ||
           static_cast<unsigned char>(c) >= 0x80;
  }

  void skip() {
    for (;;) {
      const std::size_t before = left_.size();
      while (!left_.empty() && is_space(left_.front())) left_.remove_prefix(1);
      left_ = without_mark(left_);  // a blank to SQLite
      if (left_.starts_with("--")) left_.remove_prefix(std::min(left_.find('\n'), left_.size()));
      if (left_.starts_with("/*")) {
        const std::size_t end = left_.find("*/", 2);
        left_.remove_prefix(end == std::string_view::npos ? left_.size() : end + 2);
      }
      if (left_.size() == before) return;
    }
  }

  std::string_view left_;
};

}  // namespace

std::optional<std::vector<std::string>> sqlite_schema(std::string_view bytes) try {
  std::vector<std::string> schema;
  for (Database::Entry& entry : Database(bytes).schema()) schema.push_back(std::move(entry.sql));
  return schema;
} catch (const Damaged&) {
  return {};
}

std::optional<std::vector<std::string>> sqlite_rows(std::string_view bytes, std::string_view word) try {
  Database database(bytes);
  std::vector<std::string> rows;
  for (const Database::Entry& entry : database.schema())
    if (entry.root != 0 && lower(entry.sql).find(word) != std::string::npos)
      for (std::string& row : database.rows(entry.root)) rows.push_back(std::move(row));
  return rows;
} catch (const Damaged&) {
  return {};
}

bool runs_when_read(std::string_view sql) {
  // A byte order mark inside a word would end it for SQLite and not here.
  std::string plain(sql);
  for (std::size_t at; (at = plain.find("\xEF\xBB\xBF")) != std::string::npos;) plain.replace(at, 3, " ");
  Tokens tokens(plain);
  if (tokens.next() != "create") return true;
  const std::string kind = tokens.next();
  if (kind == "index" || kind == "unique" || kind == "trigger") return false;  // nothing of them runs but on changes
  if (kind != "table" && kind != "virtual") return true;
  std::string before;
  for (std::string word = tokens.next(); !word.empty(); before = std::exchange(word, tokens.next())) {
    if (kind == "table" && (word == "generated" || (before == "as" && word == "("))) return true;
    if (kind == "virtual" && before == "using") return word != "rtree";
  }
  return kind == "virtual";
}

}  // namespace terrane
