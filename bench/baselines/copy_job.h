// Memory to be copied: what a bulk builder reads, and the planes it writes.
#ifndef HALFSPACE_BENCH_BASELINES_COPY_JOB_H_
#define HALFSPACE_BENCH_BASELINES_COPY_JOB_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

namespace halfspace::bench {

// Arrays of different lengths that describe the same objects, in the same
// order: cut into the same number of parts, part i of one describes the same
// objects as part i of another.
template <typename Byte>
struct Streams {
  struct Stream {
    Byte* begin;
    std::size_t bytes;
  };
  std::vector<Stream> list;

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Stream& stream : list) sum += stream.bytes;
    return sum;
  }
};

struct CopyJob {
  Streams<const unsigned char> reads;
  Streams<unsigned char> writes;

  template <typename T>
  void Read(const T* begin, std::size_t count) {
    reads.list.push_back(
        {reinterpret_cast<const unsigned char*>(begin), count * sizeof(T)});
  }
  void Write(float* begin, std::size_t count) {
    writes.list.push_back(
        {reinterpret_cast<unsigned char*>(begin), count * sizeof(float)});
  }
  std::size_t bytes() const { return reads.bytes() + writes.bytes(); }
};

// In which order streams are walked over: so many words of each in turn, until
// the first part of every stream is done, then the second part of each.
struct CopyOrder {
  std::size_t parts = 1;
  std::size_t words_in_turn = std::numeric_limits<std::size_t>::max();
};

// Walks over streams word by word.
template <typename Byte>
class StreamWalk {
 public:
  StreamWalk(const Streams<Byte>& streams, const CopyOrder& order,
             std::size_t word_bytes)
      : word_bytes_(word_bytes) {
    std::vector<std::size_t> left;
    for (const auto& stream : streams.list) {
      places_.push_back(stream.begin);
      left.push_back(stream.bytes / word_bytes / order.parts);
    }
    for (bool is_done = false; !is_done;) {
      is_done = true;
      for (std::size_t s = 0; s < left.size(); ++s) {
        const std::size_t words = std::min(left[s], order.words_in_turn);
        if (words == 0) continue;
        turns_.push_back({s, words});
        left[s] -= words;
        is_done = false;
      }
    }
  }

  // The next word. May be called as often as there are words.
  Byte* Next() {
    if (words_left_ == 0) {
      turn_ = turn_ + 1 == turns_.size() ? 0 : turn_ + 1;
      words_left_ = turns_[turn_].words;
      place_ = &places_[turns_[turn_].stream];
    }
    --words_left_;
    Byte* const word = *place_;
    *place_ += word_bytes_;
    return word;
  }

 private:
  struct Turn {
    std::size_t stream;
    std::size_t words;
  };

  std::size_t word_bytes_;
  std::vector<Byte*> places_;  // of each stream
  std::vector<Turn> turns_;    // of one part
  std::size_t turn_ = std::numeric_limits<std::size_t>::max();
  std::size_t words_left_ = 0;
  Byte** place_ = nullptr;
};

// Pairs the words that are written with those that are read, evenly. Where more
// is written than read, some words are read again at once, from the nearest
// cache; where less is written, a word is made of several.
class CopyWalk {
 public:
  static constexpr std::size_t kMostReads = 32;

  struct Step {
    unsigned char* to;
    std::array<const unsigned char*, kMostReads> from;
    std::size_t reads = 0;
  };

  CopyWalk(const CopyJob& job, const CopyOrder& order, std::size_t word_bytes)
      : reads_(job.reads, order, word_bytes),
        writes_(job.writes, order, word_bytes),
        read_words_(job.reads.bytes() / word_bytes),
        write_words_(job.writes.bytes() / word_bytes),
        due_(write_words_ - 1) {
    if (read_words_ / write_words_ + 1 > kMostReads) {
      throw std::logic_error("CopyWalk: too many reads for one write");
    }
  }

  std::size_t steps() const { return write_words_; }

  // Valid until the next call. May be called steps() times.
  const Step& Next() {
    step_.to = writes_.Next();
    due_ += read_words_;
    if (due_ >= write_words_) step_.reads = 0;
    for (; due_ >= write_words_; due_ -= write_words_) {
      step_.from[step_.reads++] = reads_.Next();
    }
    return step_;
  }

 private:
  StreamWalk<const unsigned char> reads_;
  StreamWalk<unsigned char> writes_;
  std::size_t read_words_;
  std::size_t write_words_;
  std::size_t due_;  // read words, in units of 1 / write_words_
  Step step_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_COPY_JOB_H_
