require "rtf"

# Tests a joint of the robot. rtf calls setup, run and tear_down, in a separate process for
# each test.
class MyRobotTest < RTF::TestCase
  # Connect here. A problem in setup is an `error`: the bench is wrong, not the robot.
  def setup(args)
    @goal = Float(args.fetch(0, 90))
    @position = 0
  end

  # Test here. The first problem decides the verdict.
  def run
    # Ends the test if it takes longer than 5 s.
    wait_until(5, "the joint at its goal") { step >= @goal }
    # A failed check does not end the test.
    check_near(@position, @goal, 0.5, "joint")
    # Stored with the result, and checked against the limits.
    measure("position", @position, "deg", low: 0, high: 180)
  end

  # Leave the robot as it was. rtf always calls it.
  def tear_down
    @position = 0
  end

  private

  # A stand-in for the robot.
  def step
    @position += 15
  end
end
