require "rtf"

class SkipInSetup < RTF::TestCase
  def setup(_args)
    skip("no robot")
  end

  def run
    report("run was called")
  end

  def tear_down
    report("torn down")
  end
end
