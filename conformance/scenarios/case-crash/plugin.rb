require "fiddle"
require "rtf"

# Reads unmapped memory, in C.
class CaseCrash < RTF::TestCase
  def run
    strlen = Fiddle::Function.new(Fiddle.dlopen(nil)["strlen"], [Fiddle::TYPE_VOIDP],
                                  Fiddle::TYPE_SIZE_T)
    poses = (1..40).map { |number| "pose #{number}" }
    plan_cases(poses)
    poses.each do |pose|
      self.case(pose) { strlen.call(1) if pose == "pose 7" }
    end
  end
end
