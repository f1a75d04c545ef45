require "rtf"

class AskInTearDown < RTF::TestCase
  def run
    report("running")
  end

  def tear_down
    ask("Is the hand closed?", default: "no")
    report("not reached")
  end
end
