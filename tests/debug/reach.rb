# Reaches for something.
class Reach < RTF::TestCase
  def run
    angle = 42
    binding.irb # rubocop:disable Lint/Debugger
    check(angle == 42, "the angle")
  end
end
