require "rtf"

# Tests the joint of the robot. rtf calls setup, run and tear_down, in a separate process for
# each test.
class MyRobotTest < RTF::TestCase
  # Connect here. A problem in setup is an `error`: the bench is wrong, not the robot.
  def setup(args)
    @goal = Float(args.fetch(0)) # param in the suite
    @state = fixture_value("simulator.state")
  end

  # Test here. The first problem decides the verdict.
  def run
    # Ends the test if it takes longer than 10 s.
    wait_until(10, "the joint at its goal") { position >= @goal }
    # A failed check does not end the test.
    check_near(position, @goal, 0.5, "joint")
    # Stored with the result, and checked against the limits.
    measure("position", position, "deg", low: 0, high: 180)
  end

  # Leave the robot as it was. rtf always calls it.
  def tear_down; end

  private

  # Reads the position from the stand-in for the robot.
  def position
    Float(File.read(@state))
  end
end
