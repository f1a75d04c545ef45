require "rtf"

class SetupFalse < RTF::TestCase
  def setup(_args)
    false
  end

  def run
    report("never")
  end

  def tear_down
    report("torn down")
  end
end
