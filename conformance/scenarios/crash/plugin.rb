require "fiddle"
require "rtf"

# Reads unmapped memory, in C.
class Crash < RTF::TestCase
  def run
    report("before the crash")
    strlen = Fiddle.dlopen(nil)["strlen"]
    Fiddle::Function.new(strlen, [Fiddle::TYPE_VOIDP], Fiddle::TYPE_SIZE_T).call(1)
  end
end
