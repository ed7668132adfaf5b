# A tag fills url and sha256 of a source archive, which has the headers of Highway.
class Halfspace < Formula
  desc "Broad phases, BVHs and SIMD rejection tests over stored bounding volumes"
  homepage "@HOMEPAGE@"
  url "@URL@"
  sha256 "@SHA256@"
  license "MIT"

  depends_on "cmake" => :build

  def install
    system "cmake", "-S", ".", "-B", "build", "-DHALFSPACE_C=ON", "-DHALFSPACE_SHARED=ON", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    (testpath/"test.c").write <<~EOS
      #include <halfspace/c/halfspace.h>
      #include <stdio.h>
      int main(void) { return puts(hs_version()) < 0; }
    EOS
    system ENV.cc, "test.c", "-DHALFSPACE_SHARED", "-I#{include}", "-L#{lib}", "-lhalfspace", "-o", "test"
    assert_equal version.to_s, shell_output("./test").strip
  end
end
