--  SPDX-License-Identifier: Apache-2.0
--  Cases: named results inside a test, with their own verdicts.

with Ada.Strings.Unbounded; use Ada.Strings.Unbounded;
with GNAT.Source_Info;

package RobotTestingFramework.Cases is

   package Source renames GNAT.Source_Info;

   --  A parameter: Named ("joint", 3).
   type Named_Value is record
      Name  : Unbounded_String;
      Value : Unbounded_String;
   end record;
   function Named (Name, Value : String) return Named_Value;
   function Named (Name : String; Value : Integer) return Named_Value;

   type Named_Values is array (Positive range <>) of Named_Value;
   No_Values : constant Named_Values (1 .. 0) := (others => <>);

   --  Runs a case, in the Run of a test. An assertion, an error, an exception or Skip ends
   --  the case, and the test continues after it. Code is not called if the case is not
   --  selected.
   procedure Run_Case
     (Name       : String;
      Code       : not null access procedure;
      Parameters : Named_Values := No_Values;
      File       : String       := Source.File;
      Line       : Natural      := Source.Line);

   function "+" (Name : String) return Unbounded_String renames To_Unbounded_String;

   type Case_Names is array (Positive range <>) of Unbounded_String;

   --  Announces cases that the test is going to run: Plan_Cases ((+"pose 1", +"pose 2")).
   procedure Plan_Cases
     (Names : Case_Names; File : String := Source.File; Line : Natural := Source.Line);

end RobotTestingFramework.Cases;
