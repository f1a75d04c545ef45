--  SPDX-License-Identifier: Apache-2.0
--  The plug-in's parameters, waiting (which a stop request ends), measurements, samples
--  and attachments.

with GNAT.Source_Info;
with RobotTestingFramework.Cases;

package RobotTestingFramework.Session is

   package Source renames GNAT.Source_Info;

   --  The plug-in's name in the suite.
   function Name return String;

   --  The parameter string in the suite, and the words in it.
   function Parameters return String;
   function Argument_Count return Natural;
   function Argument (Number : Positive) return String;

   --  The test's value of a matrix; an unknown name is an error.
   function Parameter
     (Name : String; File : String := Source.File; Line : Natural := Source.Line)
      return String;

   --  All values of the matrix.
   function Parameter_Values
     (File : String := Source.File; Line : Natural := Source.Line)
      return Cases.Named_Values;

   --  A value that a fixture provided, as text: Fixture_Value ("simulator.port"). An
   --  unknown name is an error. A fixture sees the values of the fixtures that it depends
   --  on.
   function Fixture_Value
     (Name : String; File : String := Source.File; Line : Natural := Source.Line)
      return String;

   --  The suite's environment string.
   function Environment return String;

   --  The present repetition, from 1.
   function Repetition return Positive;

   --  Whether the runner has asked to stop; long loops should poll this.
   function Interrupted return Boolean;

   --  The time since an arbitrary moment, by the suite's clock.
   function Current_Time return Duration;

   --  Sleeps by the suite's clock. A stop request ends the sleep and this step.
   procedure Sleep (Time : Duration);

   --  Waits until the condition is true, polling every 10 ms. After the timeout, the
   --  assertion fails with What.
   generic
      with function Condition return Boolean;
   procedure Wait_Until
     (Timeout : Duration;
      What    : String;
      File    : String  := Source.File;
      Line    : Natural := Source.Line);

   --  Limits that do not limit.
   No_Low  : constant Long_Float := Long_Float'First;
   No_High : constant Long_Float := Long_Float'Last;

   --  Records a number; outside its limits it is a failure, and so is a value that is
   --  not a finite number.
   procedure Measure
     (Name      : String;
      Value     : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line);

   --  The current time, as the time of a sample.
   Now : constant Long_Float := Long_Float'First;

   --  Takes a sample of a signal, in a test; outside its limits it is a failure, and so
   --  is a value that is not a finite number. The time is in seconds since the set-up
   --  began.
   procedure Sample
     (Name      : String;
      Value     : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      Time      : Long_Float := Now;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line);

   --  How the times of a signal and of a stored trajectory are aligned: both start at their
   --  first sample, or by dynamic time warping.
   type Alignment is (By_Time, By_Warping);

   --  Without a band, times may differ by a tenth of the reference.
   Default_Band : constant Long_Float := Long_Float'First;

   --  Checks that a signal, as sampled so far, stays within the tolerance of a stored
   --  trajectory: a file below the directory of the suite, which `rtf golden accept` writes.
   --  With By_Warping, times may differ by this band in seconds. The runner compares: the
   --  test continues, and a deviation is a failure.
   procedure Check_Trajectory
     (Name      : String;
      Reference : String;
      Tolerance : Long_Float;
      Align     : Alignment  := By_Time;
      Band      : Long_Float := Default_Band;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line);

   --  Checks that a picture, a PNG or JPEG file, differs by at most the tolerance (1 minus the
   --  structural similarity) from a stored one: a file below the directory of the suite, which
   --  `rtf golden accept` writes. The runner compares a copy: the test continues, and a
   --  difference is a failure.
   procedure Check_Picture
     (Name      : String;
      Picture   : String;
      Reference : String;
      Tolerance : Long_Float;
      File      : String  := Source.File;
      Line      : Natural := Source.Line);

   --  What the violation of a monitor means: a failure or an error, and whether it stops
   --  the test, or also the rest of the suite.
   type Severity is (Fail, Error, Stop, Critical);

   --  Judges the rest of the test by a formula over the signals of the suite. The
   --  default name is the formula.
   procedure Monitor
     (Formula : String;
      Name    : String   := "";
      Meaning : Severity := Fail;
      File    : String   := Source.File;
      Line    : Natural  := Source.Line);

   --  Samples the result of Read at this rate in Hz. A slow Read skips samples.
   generic
      with function Read return Long_Float;
   procedure Sample_For
     (Name      : String;
      Time      : Duration;
      Rate      : Long_Float;
      Unit      : String     := "";
      Low       : Long_Float := No_Low;
      High      : Long_Float := No_High;
      File      : String     := Source.File;
      Line      : Natural    := Source.Line);

   --  Answers that are not limited.
   No_Choices : constant Cases.Case_Names (1 .. 0) := (others => <>);

   --  How long a question waits for an answer.
   Answer_Time : constant Duration := 300.0;

   --  Asks an operator, on the console, the page or the API, and returns the answer: one of
   --  Choices, or without them any line of text: Ask ("Closed?", (+"yes", +"no")). If no operator
   --  answers in this time, or none can, it is Default; without a default, this is an error.
   --  Picture is a PNG or JPEG file. The time limit of the test is paused meanwhile.
   function Ask
     (Question : String;
      Choices  : Cases.Case_Names := No_Choices;
      Timeout  : Duration         := Answer_Time;
      Default  : String           := "";
      Picture  : String           := "";
      File     : String           := Source.File;
      Line     : Natural          := Source.Line) return String;

   --  Gives an operator an instruction, and waits until it is done. The answers are "done" and
   --  "cannot", which is an error; Default is one of them.
   procedure Instruct
     (Text    : String;
      Picture : String   := "";
      Timeout : Duration := Answer_Time;
      Default : String   := "";
      File    : String   := Source.File;
      Line    : Natural  := Source.Line);

   --  Adds a copy of a complete file to the results. The default name is the file's.
   procedure Attach (Path : String; Name : String := ""; Media_Type : String := "");

end RobotTestingFramework.Session;
