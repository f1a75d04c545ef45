require "rtf"

class FixtureValueUnknown < RTF::TestCase
  def run
    fixture_value("simulator.speed")
    report("never")
  end

  def tear_down
    report("torn down")
  end
end
