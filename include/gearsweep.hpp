// gearsweep for C++ (11 or later): the calls of gearsweep.h with exceptions, and studies that free themselves.
#ifndef GEARSWEEP_HPP
#define GEARSWEEP_HPP

#include <gearsweep.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace gearsweep {

// What a call refuses or cannot do: the sentence, and one of the codes of gearsweep.h.
struct error : std::runtime_error {
  const int code;
  error(int code, const char *message) : std::runtime_error(message), code(code) {}
};

// Makes a call of gearsweep.h, all but its last two arguments given; throws its message unless the code is GSC_OK.
template <class Call, class... Arguments> void ask(Call call, Arguments... arguments) {
  char message[400];
  const int code = call(arguments..., message, sizeof message);
  if (code != GSC_OK) throw error(code, message);
}

// The results of a case. Copies share them, and the last one frees them. Any number of threads may read one study at once.
class study {
 public:
  // Runs a case, whose files lie in folder. threads: of the sweep, 0: all. earlier: a study whose results of the same inputs are reused.
  explicit study(const std::string &text, const std::string &folder = "", int threads = 0, const study *earlier = nullptr) {
    take(gsc_run, text.data(), text.size(), folder.c_str(), threads, earlier ? earlier->get() : nullptr, nullptr, nullptr, nullptr);
  }

  // Runs a case once for each of count rows of numbers of the keys names, in values row after row; keeps the columns wanted.
  static study rows(const std::string &text, const std::string &names, int count, const std::vector<double> &values,
                    const std::string &wanted, const std::string &folder = "", int threads = 0) {
    study all;
    all.take(gsc_rows, text.data(), text.size(), folder.c_str(), threads, nullptr, nullptr, names.c_str(), count, values.data(),
             wanted.c_str());
    return all;
  }

  // GSC_OK or, where some operating points have no result, GSC_PARTIAL, which is not thrown.
  int code() const { return code_; }
  // For the calls of gearsweep.h.
  const gsc_study *get() const { return study_.get(); }

  // The numbers of a column, in the unit that its name ends with; NaN where there is no result.
  std::vector<double> column(const std::string &table, const std::string &name) const {
    int rows, kind, width;
    ask(gsc_size, get(), table.c_str(), name.c_str(), &rows, &kind, &width);
    std::vector<double> values(rows);
    ask(gsc_column, get(), table.c_str(), name.c_str(), rows, values.data());
    return values;
  }

  // The words of a column.
  std::vector<std::string> words(const std::string &table, const std::string &name) const {
    int rows, kind, width;
    ask(gsc_size, get(), table.c_str(), name.c_str(), &rows, &kind, &width);
    std::vector<std::string> values(rows, std::string(width + 1, '\0'));
    for (int row = 0; row < rows; row++) {
      ask(gsc_words, get(), table.c_str(), name.c_str(), row, &values[row][0], values[row].size());
      values[row].resize(std::char_traits<char>::length(values[row].c_str()));
    }
    return values;
  }

  // "report", "log", "tables" (JSON) or "case".
  std::string text(const std::string &what) const {
    size_t length = 0;
    gsc_text(get(), what.c_str(), nullptr, 0, &length, nullptr, 0);
    std::string said(length + 1, '\0');
    ask(gsc_text, get(), what.c_str(), &said[0], said.size(), &length);
    said.resize(length);
    return said;
  }

 private:
  study() : code_(GSC_OK) {}
  template <class Call, class... Arguments> void take(Call call, Arguments... arguments) {
    gsc_study *made = nullptr;
    char message[400];
    code_ = call(arguments..., &made, message, sizeof message);
    if (code_ != GSC_OK && code_ != GSC_PARTIAL) throw error(code_, message);
    study_.reset(made, [](gsc_study *one) { gsc_free(&one); });
  }
  int code_;
  std::shared_ptr<gsc_study> study_;
};

}  // namespace gearsweep

#endif
