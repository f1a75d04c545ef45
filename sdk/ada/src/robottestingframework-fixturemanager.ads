--  SPDX-License-Identifier: Apache-2.0
--  Fixtures: they run while tests run, for example a simulator or a driver.

--  Each plug-in has a copy of this type, and a process may hold several of them. Inside of the
--  package, the pragma would have no effect on the elaboration.
pragma Suppress (Duplicated_Tag_Check);

with GNAT.Source_Info;
private with RobotTestingFramework.Registry;

package RobotTestingFramework.FixtureManager is

   --  An attempt of a test.
   type Test (Length : Natural) is record
      Id         : Natural;
      Repetition : Positive;
      Attempt    : Positive;
      Name       : String (1 .. Length);
   end record;

   type FixtureManager is abstract tagged private;
   type FixtureManager_Access is access all FixtureManager'Class;

   --  Starts the fixture. Parameters is the parameter string in the suite. False
   --  means that it failed.
   function Setup (Self : in out FixtureManager; Parameters : String) return Boolean is abstract;

   --  Checks the fixture, before each test and while tests run. False means that
   --  it collapsed.
   function Check (Self : in out FixtureManager) return Boolean;

   --  Called before a test starts. False: the fixture collapsed.
   function TestStarted (Self : in out FixtureManager; Subject : Test) return Boolean;

   --  Called after a test with its verdict: `passed`, `failed`, `error`, `crashed`, ...
   --  Reports, measurements and attachments of this function belong to that test.
   function TestFinished
     (Self : in out FixtureManager; Subject : Test; Verdict, Reason : String) return Boolean;

   --  Stops the fixture, also after a failed Setup.
   procedure TearDown (Self : in out FixtureManager) is null;

   package Source renames GNAT.Source_Info;

   --  Provides a value for tests, hooks and dependent fixtures, in Setup.
   procedure Provide
     (Name, Value : String; File : String := Source.File; Line : Natural := Source.Line);
   procedure Provide
     (Name  : String;
      Value : Integer;
      File  : String  := Source.File;
      Line  : Natural := Source.Line);
   procedure Provide
     (Name  : String;
      Value : Long_Float;
      File  : String  := Source.File;
      Line  : Natural := Source.Line);
   procedure Provide
     (Name  : String;
      Value : Boolean;
      File  : String  := Source.File;
      Line  : Natural := Source.Line);

   --  Any other value: Provide_JSON ("limits", "[1, 2]").
   procedure Provide_JSON
     (Name, Value : String; File : String := Source.File; Line : Natural := Source.Line);

   --  Reports from any task that the fixture collapsed.
   procedure Collapsed (Reason : String);

   --  Declares the plug-in's fixture.
   generic
      type Fixture is new FixtureManager with private;
   package Register is
   private
      procedure Make;
      Registered : constant Boolean := Registry.Register (Make'Access);
   end Register;

   --  Makes this the plug-in's fixture.
   procedure SetFixture (Fixture : FixtureManager_Access);

   --  The plug-in's fixture, if it is one.
   function Current return FixtureManager_Access;

private

   type FixtureManager is abstract tagged null record;

end RobotTestingFramework.FixtureManager;
